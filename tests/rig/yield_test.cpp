// SPDX-License-Identifier: MIT
#include "test_servos.h"
#include "thermorig/rig/sweep/plan.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::rig::test {
namespace {

constexpr double rate_hz = 8.0;

SweepPlan sweep_of(const std::vector<double>& rates_dps, int frames_per_leg, int valid_per_leg) {
  SweepPlan plan;
  plan.name = "test";
  plan.leg_rates_dps = rates_dps;
  plan.frames_per_leg = frames_per_leg;
  plan.valid_per_leg = valid_per_leg;
  plan.opening_rest_s = 1.0;
  plan.closing_rest_s = 1.0;
  return plan;
}

TEST(Yield, AWindowNeedsSettlingAnExposureAndAPeriodForEachFurtherFrame) {
  const ServoProfile servo = servo_of(180.0);
  EXPECT_NEAR(window_s(1, servo, rate_hz), 0.2 + 0.25, 1e-12);
  EXPECT_NEAR(window_s(3, servo, rate_hz), 0.70, 1e-12);
  EXPECT_NEAR(window_s(6, servo, rate_hz), 1.075, 1e-12);
  // 215 deg at 200 deg/s, and 20 deg of ramps at 2,000 deg/s^2.
  EXPECT_NEAR(window_travel_deg(200.0, 6, servo, rate_hz), 215.0 + 20.0, 1e-9);
  EXPECT_NEAR(window_travel_deg(-200.0, 6, servo, rate_hz), 215.0 + 20.0, 1e-9);
}

TEST(Yield, ASweepLastsAsLongAsItsStrokeWithoutTheRamps) {
  EXPECT_NEAR(sweep_constant_s(200.0, servo_of(180.0)), (176.0 - 20.0) / 200.0, 1e-12);
  EXPECT_EQ(sweep_constant_s(200.0, servo_of(20.0)), 0.0);  // the ramps meet
  EXPECT_TRUE(std::isinf(sweep_constant_s(200.0, continuous_servo())));
}

TEST(Yield, WindowsAreCountedFromTheFirstThatFits) {
  const double settled_s = 0.1;
  EXPECT_EQ(windows_within(0.34, settled_s, 1, rate_hz), 0.0);
  EXPECT_NEAR(windows_within(0.35 + 3 * 0.125, settled_s, 1, rate_hz), 3.0, 1e-9);
  EXPECT_NEAR(windows_within(0.35 + 3 * 0.125, settled_s, 3, rate_hz), 1.0, 1e-9);
  EXPECT_EQ(windows_within(0.35 + 3 * 0.125, settled_s, 5, rate_hz), 0.0);
}

TEST(Yield, TheExpectedSettlingIsThatOfTheLoopAndNeverAboveTheGuard) {
  ServoProfile servo = servo_of(180.0);  // 8 Hz
  // 55.7 deg/s of lag fall below 4 deg/s after 42 ms and swing back by less; the next ramp is felt 17 ms
  // late.
  EXPECT_NEAR(settling_s(200.0, servo), 0.040 - 0.021, 0.002);
  EXPECT_GT(settling_s(100.0, servo), settling_s(200.0, servo));  // 2 % of less
  EXPECT_EQ(settling_s(0.4, servo), 0.0);                         // within 1 deg/s from the start
  servo.loop_hz = 1.0;
  EXPECT_NEAR(settling_s(200.0, servo), servo.settle_s, 0.07);
}

TEST(Yield, ALegThatTurnsBackSharesItsWindowsBetweenBothDirections) {
  const ServoProfile servo = servo_of(180.0);
  const LegCourse course = leg_course(100.0, 0.0, 57, servo, rate_hz);
  ASSERT_TRUE(course.turns_back());
  const double each = windows_within(course.constant_s, course.settling_s, 1, rate_hz);
  const double frames_of_a_stroke = (course.constant_s + course.reversal_s) * rate_hz;
  const LegYield three =
      leg_yield(course, course.ramp_s * rate_hz + 3 * frames_of_a_stroke + 0.01, 1, rate_hz);
  EXPECT_NEAR(three.own, 2 * each, 1e-9);
  EXPECT_NEAR(three.other, each, 1e-9);
}

TEST(Yield, FramesForAQuotaGiveThatQuota) {
  for (const double travel_deg : {2160.0, 270.0, 180.0, 120.0}) {
    const ServoProfile servo = servo_of(travel_deg);
    for (const double rate_dps : {20.0, 60.0, 110.0, 150.0}) {
      for (const double valid : {1.0, 7.0, 50.0}) {
        SCOPED_TRACE(testing::Message() << travel_deg << " deg, " << rate_dps << " deg/s, " << valid);
        const LegCourse course = leg_course(rate_dps, 0.0, 57, servo, rate_hz);
        const double frames = frames_for(valid, course, rate_hz);
        EXPECT_GE(leg_yield(course, frames, 1, rate_hz).own, valid - 1e-6);
        EXPECT_LE(leg_yield(course, frames - 1.0, 1, rate_hz).own, valid + 1e-6);
      }
    }
  }
}

TEST(Yield, NoQuotaIsEverMetWhereNoFrameFits) {
  const ServoProfile servo = servo_of(60.0);  // 56 deg: 36 without the ramps, 0.18 s
  const LegCourse course = leg_course(200.0, 0.0, 57, servo, rate_hz);
  EXPECT_TRUE(std::isinf(frames_for(1.0, course, rate_hz)));
  EXPECT_EQ(frames_for(0.0, course, rate_hz), 0.0);
}

TEST(Yield, SaysWhichWindowsAreBeyondTheServosTravel) {
  const auto speeds = plan_yield(sweep_of({200.0, -200.0, 20.0}, 57, 50), servo_of(180.0), rate_hz);
  ASSERT_EQ(speeds.size(), 2U);
  EXPECT_EQ(speeds[0].rate_dps, 20.0);
  EXPECT_TRUE(speeds[0].windows[5].possible);
  EXPECT_EQ(speeds[1].rate_dps, 200.0);
  EXPECT_TRUE(speeds[1].windows[2].possible);   // 140 deg + 20 deg of 176
  EXPECT_FALSE(speeds[1].windows[3].possible);  // 165 deg + 20 deg
  EXPECT_FALSE(speeds[1].windows[5].possible);
  EXPECT_NEAR(speeds[1].windows[5].travel_deg, 235.0, 1e-9);
  EXPECT_GT(speeds[1].windows[2].leg, 0.0);
}

TEST(Yield, AContinuousServoHasNoStops) {
  const auto speeds = plan_yield(sweep_of({200.0, -200.0}, 57, 50), continuous_servo(), rate_hz);
  ASSERT_EQ(speeds.size(), 1U);
  for (const auto& windows : speeds[0].windows) {
    EXPECT_TRUE(windows.possible);
    EXPECT_TRUE(std::isinf(windows.sweep));
    EXPECT_GT(windows.leg, 40.0);
  }
}

TEST(Yield, TheLegsOfTheDefaultRigNeedNoMoreFramesThanPlanned) {
  for (const char* name : {"paper", "table-one", "quick"}) {
    for (const char* environment : {"kitchen", "garden"}) {
      const SweepPlan plan = load_plan(name, environment, 3);
      EXPECT_GT(plan.valid_per_leg, 0) << name;
      for (const ExpectedLeg& leg : expected_legs(plan, servo_of(2160.0), rate_hz))
        EXPECT_EQ(leg.frames, plan.frames_per_leg) << name << " " << leg.rate_dps;
    }
  }
}

TEST(Yield, ALegThatGoesBackAndForthSparesTheOneInTheOtherDirection) {
  const auto legs = expected_legs(sweep_of({150.0, -150.0}, 57, 50), servo_of(180.0), rate_hz);
  ASSERT_EQ(legs.size(), 2U);
  EXPECT_GT(legs[0].frames, 2 * 57);
  EXPECT_EQ(legs[1].frames, 57);
}

TEST(Yield, StaysFiniteWithOddPlans) {
  for (const double travel_deg : {4.0, 60.0, 2160.0}) {
    for (const auto& rates_dps : {std::vector<double>{}, {0.01}, {300.0, 300.0, 300.0}}) {
      SweepPlan plan = sweep_of(rates_dps, 1, 1'000'000);
      EXPECT_TRUE(std::isfinite(plan_duration_s(plan, servo_of(travel_deg), rate_hz)));
      EXPECT_LE(plan_yield(plan, servo_of(travel_deg), rate_hz).size(), 1U);
    }
  }
}

/// Valid frames by the speed and direction that was commanded, as the session has them.
std::map<double, int> valid_by_speed(const session::Session& session, const SweepPlan& plan) {
  ValidQuota quota(plan);
  for (const LegRecord& leg : session.raw.legs) quota.leg(leg.leg, leg.rate_dps);
  for (const LabelledSample& sample : session.samples) quota.sample(sample);
  std::map<double, int> valid;
  for (const SpeedQuota& speed : quota.speeds()) valid[speed.rate_dps] = speed.valid;
  return valid;
}

TEST(Yield, IsWhatARecordingThenHas) {
  for (const double travel_deg : {2160.0, 270.0, 180.0}) {
    auto config = simulation::default_rig(5, "kitchen");
    config.profile.servo.travel_deg = travel_deg;
    const SweepPlan plan = sweep_of({40.0, -40.0, 120.0, -120.0, 200.0, -200.0}, 57, 0);
    const TemporaryFolder folder;
    SimulatedBus bus(config);
    const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, plan));
    ASSERT_FALSE(run.failure) << run.failure->what();
    const session::Session session = build_session(run.raw);
    const double measured_hz = 1.0 / session.frame_period_s;  // the simulated camera is 2 % slow
    std::map<double, double> expected, sweeps;
    for (const ExpectedLeg& leg : expected_legs(plan, config.profile.servo, measured_hz)) {
      const LegYield yield = leg_yield(leg.course, leg.frames, 1, measured_hz);
      expected[leg.rate_dps] += yield.own;
      expected[-leg.rate_dps] += yield.other;
      const double sweep_s = leg.course.constant_s + leg.course.reversal_s;
      sweeps[std::abs(leg.rate_dps)] += 1.0 + 0.5 * leg.frames / measured_hz / sweep_s;  // each way
    }
    const auto valid = valid_by_speed(session, plan);
    for (const auto& [rate_dps, frames] : expected) {
      const double tolerance = 1.0 + 0.4 * sweeps.at(std::abs(rate_dps));  // the camera's phase in each sweep
      EXPECT_NEAR(valid.at(rate_dps), frames, tolerance) << travel_deg << " deg, " << rate_dps << " deg/s";
    }
  }
}

}  // namespace
}  // namespace thermorig::rig::test

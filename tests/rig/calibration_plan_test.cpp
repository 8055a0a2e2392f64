// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "simulated_bus.h"
#include "test_servos.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig::test {
namespace {

constexpr CalibrationKind kinds[] = {CalibrationKind::bias,  CalibrationKind::latency,
                                     CalibrationKind::scale, CalibrationKind::orientation,
                                     CalibrationKind::lens,  CalibrationKind::encoder};

constexpr CalibrationKind all_kinds[] = {
    CalibrationKind::bias, CalibrationKind::latency, CalibrationKind::scale,  CalibrationKind::orientation,
    CalibrationKind::lens, CalibrationKind::check,   CalibrationKind::encoder};

TEST(CalibrationPlan, CanBeDrivenByEveryServo) {
  for (const ServoProfile& servo :
       {servo_of(2160.0), servo_of(270.0), servo_of(180.0), servo_of(60.0), continuous_servo()}) {
    for (const CalibrationKind kind : kinds) {
      const SweepPlan plan = calibration_plan(kind, servo, CameraProfile{});
      RecordingHeader header;
      header.plan_toml = to_toml(plan);
      EXPECT_TRUE(session::is_for_calibration(header));  // training leaves it out
      EXPECT_EQ(plan.valid_per_leg, 0);
      EXPECT_NO_THROW(check_plan(plan, servo, CameraProfile{})) << plan.name;
      for (const ExpectedLeg& leg : expected_legs(plan, servo, 8.0))
        EXPECT_FALSE(leg.course.turns_back()) << plan.name << " " << leg.rate_dps;
    }
  }
}

TEST(CalibrationPlan, OfTheBiasIsAMinuteOfRest) {
  const SweepPlan plan = calibration_plan(CalibrationKind::bias, servo_of(2160.0), CameraProfile{});
  EXPECT_TRUE(plan.leg_rates_dps.empty());
  EXPECT_GE(plan.opening_rest_s, 60.0);
}

TEST(CalibrationPlan, OfTheLatencyReversesEveryTwoSecondsForAMinute) {
  for (const double travel_deg : {2160.0, 180.0}) {
    const ServoProfile servo = servo_of(travel_deg);
    const SweepPlan plan = calibration_plan(CalibrationKind::latency, servo, CameraProfile{});
    const auto legs = expected_legs(plan, servo, 8.0);
    double before_dps = 0.0, duration_s = 0.0;
    for (const ExpectedLeg& leg : legs) {
      EXPECT_LE(leg.rate_dps * before_dps, 0.0) << "the same direction twice";
      EXPECT_GT(leg.duration_s, 1.5);
      EXPECT_LT(leg.duration_s, 3.0);
      EXPECT_LE(std::abs(leg.rate_dps), 120.0);
      EXPECT_GE(std::abs(leg.rate_dps), 35.0);
      before_dps = leg.rate_dps;
      duration_s += leg.duration_s;
    }
    EXPECT_NEAR(duration_s, 60.0, 5.0) << travel_deg;
  }
}

TEST(CalibrationPlan, OfTheScaleTurnsMoreThanOnceOrLeavesItToTheOperator) {
  const SweepPlan winch = calibration_plan(CalibrationKind::scale, servo_of(2160.0), CameraProfile{});
  ASSERT_EQ(winch.leg_rates_dps.size(), 6U);
  for (std::size_t i = 1; i < winch.leg_rates_dps.size(); ++i)
    EXPECT_EQ(winch.leg_rates_dps[i], -winch.leg_rates_dps[i - 1]);
  EXPECT_GE(winch.leg_rates_dps[0] * winch.frames_per_leg / CameraProfile{}.output_rate_hz, 400.0);
  for (const double travel_deg : {270.0, 180.0}) {
    const SweepPlan plan = calibration_plan(CalibrationKind::scale, servo_of(travel_deg), CameraProfile{});
    EXPECT_TRUE(plan.leg_rates_dps.empty()) << travel_deg;
    EXPECT_GE(plan.opening_rest_s, 60.0);
  }
}

TEST(CalibrationPlan, OfTheCheckDrivesTwoSpeedsBothWaysInHalfAMinute) {
  for (const ServoProfile& servo :
       {servo_of(2160.0), servo_of(270.0), servo_of(180.0), servo_of(60.0), continuous_servo()}) {
    const SweepPlan plan = calibration_plan(CalibrationKind::check, servo, CameraProfile{});
    EXPECT_TRUE(plan.for_calibration);
    EXPECT_NO_THROW(check_plan(plan, servo, CameraProfile{})) << servo.travel_deg;
    std::set<double> speeds(plan.leg_rates_dps.begin(), plan.leg_rates_dps.end());
    ASSERT_EQ(speeds.size(), 4U) << servo.travel_deg;
    for (const double rate_dps : speeds) EXPECT_TRUE(speeds.contains(-rate_dps)) << servo.travel_deg;
    EXPECT_GE(plan.opening_rest_s + plan.closing_rest_s, 6.0);
    EXPECT_LE(plan_duration_s(plan, servo, 8.0), 30.0) << servo.travel_deg;
  }
}

TEST(CalibrationPlan, OfTheCheckTurnsMoreThanOnceWhereTheServoCan) {
  const auto turns_deg = [](const ServoProfile& servo) {
    const SweepPlan plan = calibration_plan(CalibrationKind::check, servo, CameraProfile{});
    return plan.leg_rates_dps[0] == plan.leg_rates_dps[1]
               ? 2.0 * plan.leg_rates_dps[0] * plan.frames_per_leg / CameraProfile{}.output_rate_hz
               : 0.0;
  };
  EXPECT_GE(turns_deg(servo_of(2160.0)), 400.0);
  EXPECT_GE(turns_deg(continuous_servo()), 400.0);
  EXPECT_EQ(turns_deg(servo_of(270.0)), 0.0);
}

TEST(CalibrationPlan, TextGivesTheSamePlanBack) {
  for (const CalibrationKind kind : all_kinds) {
    const SweepPlan plan = calibration_plan(kind, servo_of(180.0), CameraProfile{});
    const SweepPlan again = parse_plan(to_toml(plan), "stored", 0);
    EXPECT_TRUE(again.for_calibration);
    EXPECT_EQ(again.leg_rates_dps, plan.leg_rates_dps);
    EXPECT_EQ(again.frames_per_leg, plan.frames_per_leg);
    EXPECT_EQ(again.valid_per_leg, 0);
    EXPECT_EQ(again.opening_rest_s, plan.opening_rest_s);
  }
}

TEST(CalibrationPlan, IsDrivenToItsEnd) {
  for (const CalibrationKind kind : all_kinds) {
    const TemporaryFolder folder;
    auto config = simulation::default_rig(4, "kitchen");
    config.profile.servo.travel_deg = 180.0;
    SimulatedBus bus(config);
    const SweepPlan plan = calibration_plan(kind, config.profile.servo, config.profile.camera);
    const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, plan));
    ASSERT_FALSE(run.failure) << plan.name << ": " << run.failure->what();
    EXPECT_GE(run.raw.legs.size(), plan.leg_rates_dps.size());
    EXPECT_LE(run.raw.legs.size(),
              plan.leg_rates_dps.size() + 2);  // a frame at a leg's very end is not counted
    const double planned_s = plan_duration_s(plan, config.profile.servo, 8.0);
    EXPECT_NEAR(to_s(run.end - HostTime{}), planned_s + 2.0, 0.1 * planned_s + 2.0) << plan.name;
  }
}

}  // namespace
}  // namespace thermorig::rig::test

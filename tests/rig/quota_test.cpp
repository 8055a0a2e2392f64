// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/quota.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::rig::test {
namespace {

SweepPlan plan_of(const std::vector<double>& rates_dps, int frames_per_leg, int valid_per_leg) {
  SweepPlan plan;
  plan.name = "test";
  plan.leg_rates_dps = rates_dps;
  plan.frames_per_leg = frames_per_leg;
  plan.valid_per_leg = valid_per_leg;
  plan.opening_rest_s = 2.0;  // until the clocks are known
  plan.closing_rest_s = 0.5;
  return plan;
}

LabelledSample valid_sample(std::uint16_t leg, float rate_dps) {
  LabelledSample sample;
  sample.leg = leg;
  sample.rate_commanded_dps = rate_dps;
  sample.rate_shaft_dps = rate_dps;
  sample.valid = true;
  return sample;
}

TEST(ValidQuota, CountsTheDirectionThatWasDriven) {
  ValidQuota quota(plan_of({30.0, -30.0}, 12, 2));
  quota.leg(1, 30.0);
  quota.sample(valid_sample(1, 30.0F));
  quota.sample(valid_sample(1, -30.0F));  // on its way back
  quota.sample(valid_sample(1, -30.0F));
  EXPECT_EQ(quota.missing(0), 1);
  EXPECT_EQ(quota.missing(1), 0);
}

TEST(ValidQuota, DoesNotCountWhatIsInvalidOrOfNoLeg) {
  ValidQuota quota(plan_of({30.0}, 12, 2));
  quota.leg(1, 30.0);
  LabelledSample invalid = valid_sample(1, std::numeric_limits<float>::quiet_NaN());
  invalid.valid = false;
  quota.sample(invalid);
  quota.sample(valid_sample(0, 30.0F));
  quota.sample(valid_sample(7, 30.0F));
  EXPECT_EQ(quota.missing(0), 2);
}

TEST(ValidQuota, WantsTwiceAsManyOfASpeedThatIsDrivenTwice) {
  ValidQuota quota(plan_of({30.0, 40.0, 30.0}, 12, 2));
  quota.leg(1, 30.0);
  for (int i = 0; i < 3; ++i) quota.sample(valid_sample(1, 30.0F));
  EXPECT_EQ(quota.missing(0), 0);
  EXPECT_EQ(quota.missing(1), 2);
  EXPECT_EQ(quota.missing(2), 1);
  ASSERT_EQ(quota.speeds().size(), 2U);
  EXPECT_EQ(quota.speeds()[0].wanted, 4);
  EXPECT_EQ(quota.speeds()[0].valid, 3);
}

TEST(ValidQuota, AllowsTheSessionsLabelsToFindTwoFewer) {
  EXPECT_FALSE((SpeedQuota{30.0, 48, 50}.is_short()));
  EXPECT_TRUE((SpeedQuota{30.0, 47, 50}.is_short()));
  EXPECT_FALSE((SpeedQuota{30.0, 0, 0}.is_short()));
}

/// A recording on a servo of that travel, and what its session holds.
struct Recorded {
  DrivenRun run;
  session::Session session;
  std::map<double, int> valid;  // by speed, signed
};
Recorded record(double travel_deg, const SweepPlan& plan, const RunOptions& options = {},
                const std::function<void(SimulatedBus&)>& prepare = {}) {
  auto config = simulation::default_rig(4, "kitchen");
  config.profile.servo.travel_deg = travel_deg;
  const TemporaryFolder folder;
  SimulatedBus bus(config);
  if (prepare) prepare(bus);
  Recorded recorded;
  recorded.run = run_to_journal(bus, recording_options(folder, config.profile, plan), options);
  recorded.session = build_session(recorded.run.raw);
  ValidQuota quota(plan);
  for (const LegRecord& leg : recorded.session.raw.legs) quota.leg(leg.leg, leg.rate_dps);
  for (const LabelledSample& sample : recorded.session.samples) quota.sample(sample);
  for (const SpeedQuota& speed : quota.speeds()) recorded.valid[speed.rate_dps] = speed.valid;
  return recorded;
}

std::set<int> complete_steps(const Recorded& recorded) {
  std::set<int> steps;
  for (const LegRecord& leg : recorded.session.raw.legs)
    if (leg.complete) steps.insert(leg.step);
  return steps;
}

std::ptrdiff_t count_events(const Recorded& recorded, EventKind kind) {
  return std::count_if(recorded.run.raw.events.begin(), recorded.run.raw.events.end(),
                       [&](const RecordingEvent& event) { return event.kind == kind; });
}

TEST(Quota, OneLegOfTheDefaultRigMeetsIt) {
  const SweepPlan plan = plan_of({100.0, -100.0, 200.0, -200.0}, 57, 50);
  const Recorded recorded = record(2160.0, plan);
  ASSERT_FALSE(recorded.run.failure);
  ASSERT_EQ(recorded.session.raw.legs.size(), 4U);
  for (const LegRecord& leg : recorded.session.raw.legs) EXPECT_LE(leg.frames, 59) << leg.rate_dps;
  for (const auto& [rate_dps, valid] : recorded.valid) EXPECT_GE(valid, 50) << rate_dps;
}

TEST(Quota, AServoWithLittleTravelGoesOnUntilBothDirectionsHaveIt) {
  for (const double travel_deg : {180.0, 270.0}) {
    const SweepPlan plan = plan_of({150.0, -150.0}, 30, 23);
    const Recorded recorded = record(travel_deg, plan);
    ASSERT_FALSE(recorded.run.failure);
    EXPECT_THAT(complete_steps(recorded), ::testing::ElementsAre(0, 1));
    EXPECT_EQ(recorded.session.raw.legs.size(), 2U);
    EXPECT_GT(recorded.session.raw.legs[0].frames, 60) << travel_deg;
    EXPECT_LE(recorded.session.raw.legs[1].frames, 60) << travel_deg;  // the first leg filled it already
    for (const auto& [rate_dps, valid] : recorded.valid)
      EXPECT_GE(valid, 23) << travel_deg << ", " << rate_dps;
  }
}

TEST(Quota, WithoutOneALegEndsWithItsFrames) {
  const Recorded recorded = record(180.0, plan_of({150.0, -150.0}, 30, 0));
  ASSERT_EQ(recorded.session.raw.legs.size(), 2U);
  for (const LegRecord& leg : recorded.session.raw.legs) EXPECT_LE(leg.frames, 32);
}

TEST(Quota, AWinchGoesOnInTheSameLegWhereFramesWereSpoilt) {
  RunOptions options;
  std::optional<HostTime> spoilt_from;
  const SweepPlan plan = plan_of({100.0, -100.0}, 30, 23);
  options.each_step = [&](Recording& recording, HostTime now) {
    const SweepProgress sweep = recording.progress(now).sweep;
    if (!spoilt_from && sweep.leg == 1 && sweep.frames == 10) spoilt_from = now;
  };
  const Recorded recorded = record(2160.0, plan, options, [&](SimulatedBus& bus) {
    bus.is_cut = [&](Device device, HostTime at) {  // no gyro for a second
      return device == Device::gyro && spoilt_from && at - *spoilt_from < std::chrono::seconds(1);
    };
  });
  ASSERT_FALSE(recorded.run.failure);
  ASSERT_EQ(recorded.session.raw.legs.size(), 2U);
  EXPECT_GT(recorded.session.raw.legs[0].frames, 32);
  EXPECT_LE(recorded.session.raw.legs[1].frames, 32);
  for (const auto& [rate_dps, valid] : recorded.valid) EXPECT_GE(valid, 23) << rate_dps;
}

TEST(Quota, AWinchOutOfTravelDrivesTheStepOnceMore) {
  RunOptions options;
  std::optional<HostTime> spoilt_from;
  const SweepPlan plan = plan_of({200.0, -200.0}, 24, 17);
  options.each_step = [&](Recording& recording, HostTime now) {
    const SweepProgress sweep = recording.progress(now).sweep;
    if (!spoilt_from && sweep.leg == 1 && sweep.frames == 6) spoilt_from = now;
  };
  // 25 frames take 650 deg: there is no room for more.
  const Recorded recorded = record(690.0, plan, options, [&](SimulatedBus& bus) {
    bus.is_cut = [&](Device device, HostTime at) {
      return device == Device::gyro && spoilt_from && at - *spoilt_from < std::chrono::milliseconds(1800);
    };
  });
  ASSERT_FALSE(recorded.run.failure);
  EXPECT_EQ(count_events(recorded, EventKind::servo_fault), 0);
  EXPECT_EQ(count_events(recorded, EventKind::leg_repeated), 1);
  ASSERT_EQ(recorded.session.raw.legs.size(), 3U);
  EXPECT_EQ(recorded.session.raw.legs[0].step, 0);
  EXPECT_EQ(recorded.session.raw.legs[0].leg, 1);
  EXPECT_EQ(recorded.session.raw.legs[2].step, 0);
  EXPECT_EQ(recorded.session.raw.legs[2].leg, 3);
  EXPECT_EQ(recorded.session.raw.legs[1].step, 1);
  for (const auto& [rate_dps, valid] : recorded.valid) EXPECT_GE(valid, 17) << rate_dps;
}

TEST(Quota, TheLastStepIsDrivenOnceMoreBeforeTheEnd) {
  RunOptions options;
  std::optional<HostTime> spoilt_from;
  const SweepPlan plan = plan_of({200.0}, 24, 17);
  options.each_step = [&](Recording& recording, HostTime now) {
    const SweepProgress sweep = recording.progress(now).sweep;
    if (!spoilt_from && sweep.frames == 22) spoilt_from = now;  // seen only when the leg is over
  };
  const Recorded recorded = record(2160.0, plan, options, [&](SimulatedBus& bus) {
    bus.is_cut = [&](Device device, HostTime at) {
      return device == Device::gyro && spoilt_from && at - *spoilt_from < std::chrono::milliseconds(1500);
    };
  });
  ASSERT_FALSE(recorded.run.failure);
  EXPECT_EQ(count_events(recorded, EventKind::finished), 1);
  EXPECT_GE(recorded.valid.at(200.0), 17);
}

TEST(Quota, IsGivenUpWhereNothingBecomesValid) {
  const SweepPlan plan = plan_of({60.0, -60.0}, 12, 5);
  bool began = false;
  RunOptions options;
  options.each_step = [&](Recording& recording, HostTime now) {
    began = began || recording.progress(now).sweep.phase == SweepPhase::leg;
  };
  const Recorded recorded = record(2160.0, plan, options, [&](SimulatedBus& bus) {
    bus.is_cut = [&](Device device, HostTime at) {  // a gyro that stutters: half of each second is missing
      return device == Device::gyro && began && to_ns(at) % 250'000'000 < 180'000'000;
    };
  });
  ASSERT_FALSE(recorded.run.failure) << recorded.run.failure->what();
  EXPECT_EQ(count_events(recorded, EventKind::finished), 1);
  EXPECT_EQ(count_events(recorded, EventKind::warning), 2);
  for (const LegRecord& leg : recorded.session.raw.legs) EXPECT_LE(leg.frames, 20 * 12);
}

TEST(Quota, AnUnmetOneIsToldInTheResult) {
  auto config = simulation::default_rig(4, "kitchen");
  const SweepPlan plan = plan_of({60.0, -60.0}, 12, 5);
  const TemporaryFolder folder;
  SimulatedBus bus(config);
  bus.is_cut = [&](Device device, HostTime at) {
    return device == Device::gyro && to_ns(at) % 250'000'000 < 180'000'000;
  };
  VirtualOptions options;
  options.recording = recording_options(folder, config.profile, plan);
  const RecordingResult result = record_virtual(bus, options);
  EXPECT_EQ(result.exit, ExitCode::finished_lossy);
  ASSERT_EQ(result.speeds.size(), 2U);
  for (const SpeedQuota& speed : result.speeds) {
    EXPECT_EQ(speed.wanted, 5);
    EXPECT_TRUE(speed.is_short()) << speed.valid;
  }
}

}  // namespace
}  // namespace thermorig::rig::test

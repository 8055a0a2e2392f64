// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::rig::test {
namespace {

std::vector<LegRecord> complete_legs(const DrivenRun& run) {
  std::vector<LegRecord> legs;
  std::copy_if(run.raw.legs.begin(), run.raw.legs.end(), std::back_inserter(legs),
               [](const LegRecord& leg) { return leg.complete; });
  return legs;
}

bool has_event(const RawRecording& raw, EventKind kind) {
  return std::any_of(raw.events.begin(), raw.events.end(),
                     [&](const auto& event) { return event.kind == kind; });
}

double rate_at_end(const SimulatedBus& bus) {
  return bus.rig.shaft().back().rate_dps;
}

TEST(Sweep, GivesEachLegOfThePlanItsFrames) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  const SweepPlan plan = short_plan();
  const DrivenRun run = run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  ASSERT_EQ(run.raw.legs.size(), plan.leg_rates_dps.size());
  for (std::size_t i = 0; i < plan.leg_rates_dps.size(); ++i) {
    EXPECT_EQ(run.raw.legs[i].step, static_cast<int>(i));
    EXPECT_EQ(run.raw.legs[i].leg, i + 1);
    EXPECT_EQ(run.raw.legs[i].rate_dps, plan.leg_rates_dps[i]);
    EXPECT_EQ(run.raw.legs[i].frames, plan.frames_per_leg);
    EXPECT_TRUE(run.raw.legs[i].complete);
  }
  EXPECT_TRUE(has_event(run.raw, EventKind::finished));
}

TEST(Sweep, TellsTheSpeedOfTheLegThatIsDrivenAndNoneOutside) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  const SweepPlan plan = short_plan();
  std::set<int> told;
  RunOptions options;
  options.each_step = [&](Recording& recording, HostTime now) {
    const SweepProgress sweep = recording.progress(now).sweep;
    const bool drives = sweep.phase == SweepPhase::leg;
    if (drives) told.insert(sweep.leg);
    EXPECT_EQ(sweep.rate_dps, drives ? plan.leg_rates_dps.at(static_cast<std::size_t>(sweep.leg - 1)) : 0.0);
  };
  run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan), options);
  EXPECT_EQ(told.size(), plan.leg_rates_dps.size());
}

TEST(Sweep, CountsAFrameForTheLegThatItsLabelNames) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(4, "kitchen"));
  const DrivenRun run =
      run_to_journal(bus, recording_options(folder, simulation::default_profile(), short_plan()));
  const std::vector<int> frames = frames_by_leg(run.raw);
  ASSERT_EQ(frames.size(), 5U);
  for (std::size_t leg = 1; leg < 4; ++leg) EXPECT_EQ(frames[leg], 12) << "leg " << leg;
  EXPECT_GE(frames[4], 12);
  EXPECT_LE(frames[4], 13);  // it ends in rest and may hold the frame of its ramp
}

/// Of the legs that were driven to their end: how many have so many frames by their labels.
std::map<int, int> complete_legs_by_frames(const simulation::VirtualRigConfig& config,
                                           const SweepPlan& plan) {
  const TemporaryFolder folder;
  SimulatedBus bus(config);
  const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, plan));
  EXPECT_FALSE(run.failure);
  const std::vector<int> labelled = frames_by_leg(run.raw);
  std::map<int, int> legs;
  std::set<int> steps;
  for (const LegRecord& leg : build_session(run.raw).raw.legs) {
    EXPECT_EQ(leg.frames, labelled.at(leg.leg)) << "leg " << leg.leg;
    if (!leg.complete) continue;
    ++legs[leg.frames];
    const bool ends_in_rest = leg.step + 1 == static_cast<int>(plan.leg_rates_dps.size());
    EXPECT_GE(leg.frames, plan.frames_per_leg) << "leg " << leg.leg;
    EXPECT_LE(leg.frames, plan.frames_per_leg + (ends_in_rest ? 2 : 1)) << "leg " << leg.leg;
    EXPECT_TRUE(steps.insert(leg.step).second) << "step " << leg.step << " was driven twice";
  }
  EXPECT_EQ(steps.size(), plan.leg_rates_dps.size());
  return legs;
}

TEST(Sweep, NoLegIsShortOfAFrameAndNoneHasMoreThanOneTooMany) {
  SweepPlan plan = load_plan("quick", "kitchen", 1);
  plan.valid_per_leg = 0;  // a quota lets legs grow
  int exact = 0, all = 0;
  for (const double travel_deg : {2160.0, 270.0}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      auto config = simulation::default_rig(seed, "kitchen");
      config.profile.servo.travel_deg = travel_deg;
      SCOPED_TRACE(testing::Message() << travel_deg << " deg, seed " << seed);
      for (const auto& [frames, legs] : complete_legs_by_frames(config, plan)) {
        if (frames == plan.frames_per_leg) exact += legs;
        all += legs;
      }
    }
  }
  EXPECT_EQ(all, 2 * 3 * 6);
  EXPECT_GE(exact, all * 3 / 4);  // the last legs hold the frame of their ramp
}

TEST(Sweep, DrivesALegAgainThatLacksItsLastFrame) {
  for (const int step : {1, 3}) {  // of four: 3 is the last, whose lack shows in the closing rest only
    const TemporaryFolder folder;
    SimulatedBus bus(simulation::default_rig(3, "kitchen"));
    const SweepPlan plan = short_plan();
    std::optional<HostTime> cut_from;
    bus.is_cut = [&](Device device, HostTime at) {
      return device == Device::camera && cut_from && at - *cut_from < std::chrono::milliseconds(150);
    };
    RunOptions options;
    options.each_step = [&](Recording& recording, HostTime now) {
      const SweepProgress sweep = recording.progress(now).sweep;
      const bool last_is_due = sweep.leg == step + 1 && sweep.frames == plan.frames_per_leg - 1;
      if (last_is_due && !cut_from) cut_from = now;
    };
    const DrivenRun run =
        run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan), options);
    ASSERT_FALSE(run.failure) << run.failure->what();
    EXPECT_TRUE(has_event(run.raw, EventKind::leg_repeated)) << step;
    EXPECT_TRUE(has_event(run.raw, EventKind::finished)) << step;
    const std::vector<LegRecord> legs = complete_legs(run);
    EXPECT_EQ(legs.size(), plan.leg_rates_dps.size());
    EXPECT_EQ(run.raw.legs.size(), plan.leg_rates_dps.size() + 1);
    for (const LegRecord& leg : build_session(run.raw).raw.legs) {
      if (!leg.complete) continue;
      EXPECT_GE(leg.frames, plan.frames_per_leg) << "leg " << leg.leg;
    }
  }
}

TEST(Sweep, RunsTwiceTheSameInVirtualTime) {
  const TemporaryFolder folder;
  std::vector<RawRecording> raws;
  for (int i = 0; i < 2; ++i) {
    SimulatedBus bus(simulation::default_rig(5, "garden"));
    raws.push_back(
        run_to_journal(bus, recording_options(folder, simulation::default_profile(), short_plan())).raw);
  }
  for (const Device device : all_devices) {
    EXPECT_EQ(raws[0].received[device].bytes, raws[1].received[device].bytes);
    EXPECT_EQ(raws[0].received[device].chunk_end, raws[1].received[device].chunk_end);
    EXPECT_EQ(raws[0].received[device].time_ns, raws[1].received[device].time_ns);
  }
  EXPECT_EQ(raws[0].sent[Device::servo].bytes, raws[1].sent[Device::servo].bytes);
  EXPECT_EQ(raws[0].sent[Device::servo].time_ns, raws[1].sent[Device::servo].time_ns);
}

TEST(Sweep, ThatRepeatsEndsWhereTheNumbersOfLegsEnd) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  SweepPlan plan = short_plan();
  plan.repeat = true;
  plan.last_leg = 6;  // in the middle of the second round
  const DrivenRun run = run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan),
                                       {.stop_at_s = 120.0});
  ASSERT_FALSE(run.failure) << run.failure->what();
  EXPECT_FALSE(run.stopped);
  ASSERT_EQ(run.raw.legs.size(), 6U);
  for (std::size_t i = 0; i < run.raw.legs.size(); ++i) EXPECT_EQ(run.raw.legs[i].leg, i + 1);
  EXPECT_TRUE(has_event(run.raw, EventKind::finished));
}

TEST(Sweep, DrivesALegAgainAfterTheWatchdogTripped) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(6, "kitchen"));
  bus.to_servo = [](std::vector<std::uint8_t> bytes, HostTime now) {
    const double time_s = to_s(now - HostTime{});
    return time_s > 2.5 && time_s < 2.8 ? std::vector<std::uint8_t>{} : bytes;
  };
  const SweepPlan plan = short_plan();
  const DrivenRun run = run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  EXPECT_TRUE(has_event(run.raw, EventKind::servo_fault));
  EXPECT_TRUE(has_event(run.raw, EventKind::leg_repeated));
  ASSERT_EQ(run.raw.legs.size(), plan.leg_rates_dps.size() + 1);
  const auto cut =
      std::find_if(run.raw.legs.begin(), run.raw.legs.end(), [](const auto& leg) { return !leg.complete; });
  ASSERT_NE(cut, run.raw.legs.end());
  EXPECT_EQ((cut + 1)->step, cut->step);
  EXPECT_EQ((cut + 1)->leg, cut->leg + 1);
  EXPECT_EQ(complete_legs(run).size(), plan.leg_rates_dps.size());
}

/// From 2.5 s to `end_s` the host is too busy to say anything for half of the time.
SimulatedBus::Damage busy_until(double end_s) {
  return [end_s](std::vector<std::uint8_t> bytes, HostTime now) {
    const double time_s = to_s(now - HostTime{});
    const bool busy = time_s > 2.5 && time_s < end_s && std::fmod(time_s, 0.6) < 0.3;
    return busy ? std::vector<std::uint8_t>{} : bytes;
  };
}

TEST(Sweep, OutlastsAHostThatIsBusyForSeconds) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(6, "kitchen"));
  bus.to_servo = busy_until(8.0);
  const SweepPlan plan = short_plan();
  const DrivenRun run = run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  EXPECT_TRUE(has_event(run.raw, EventKind::servo_fault));
  EXPECT_EQ(complete_legs(run).size(), plan.leg_rates_dps.size());
}

TEST(Sweep, SaysHowOftenTheWatchdogTrippedInARecordingThatTookLonger) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(6, "kitchen"));
  bus.to_servo = busy_until(8.0);
  VirtualOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  const RecordingResult result = record_virtual(bus, options);
  EXPECT_THAT(result.message,
              ::testing::MatchesRegex("the plan is complete; the servo's watchdog tripped [0-9]+ times, and "
                                      "the legs that this cut short were repeated"));
  EXPECT_THAT(result.advice, ::testing::HasSubstr("too busy"));
}

TEST(Sweep, NamesABusyHostWhenTheWatchdogTripsAgainAndAgain) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(6, "kitchen"));
  bus.to_servo = busy_until(100.0);
  const DrivenRun run =
      run_to_journal(bus, recording_options(folder, simulation::default_profile(), short_plan()));
  ASSERT_TRUE(run.failure);
  EXPECT_EQ(run.failure->code(), ExitCode::device_lost);
  EXPECT_THAT(run.failure->what_happened(), ::testing::HasSubstr("watchdog"));
  EXPECT_THAT(run.failure->advice(), ::testing::HasSubstr("too busy"));
}

TEST(Sweep, GivesUpWhenALegFailsAgainAndAgain) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(6, "kitchen"));
  HostTime last{};
  bus.to_servo = [&](std::vector<std::uint8_t> bytes, HostTime now) {  // a stop byte every second
    if (now - last < std::chrono::seconds(1)) return bytes;
    last = now;
    bytes.push_back(wire::stop_bytes().front());
    return bytes;
  };
  const DrivenRun run =
      run_to_journal(bus, recording_options(folder, simulation::default_profile(), short_plan()));
  ASSERT_TRUE(run.failure);
  EXPECT_EQ(run.failure->code(), ExitCode::device_lost);
  EXPECT_THAT(run.failure->what(), ::testing::HasSubstr("stop byte"));
  EXPECT_TRUE(complete_legs(run).empty());
}

TEST(Sweep, GoesBackAndForthWhereTheTravelIsShort) {
  const TemporaryFolder folder;
  auto config = simulation::default_rig(7, "dining");
  config.profile.servo.model = "180 degrees";
  config.profile.servo.travel_deg = 180.0;
  SimulatedBus bus(config);
  PlanOverrides overrides;
  overrides.magnitudes_dps = {100.0};
  overrides.frames_per_leg = 40;
  overrides.opening_rest_s = overrides.closing_rest_s = 0.5;
  const SweepPlan plan = load_plan("quick", "dining", 1, overrides);
  const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  ASSERT_EQ(complete_legs(run).size(), 2U);
  const session::Session session = build_session(run.raw);
  int forth = 0, back = 0;
  for (const LabelledSample& sample : session.samples) {
    if (!sample.valid || sample.leg != 1) continue;
    EXPECT_NEAR(std::abs(sample.rate_commanded_dps), 100.0, 2.0);  // a ramp may just begin
    ++(sample.rate_commanded_dps > 0.0F ? forth : back);
  }
  EXPECT_GT(forth, 5);
  EXPECT_GT(back, 5);
  for (const TimedServo& servo : session.servo) EXPECT_LE(std::abs(servo.state.angle_deg), 88.0);
}

TEST(Sweep, DrivesAContinuousServoWithoutLimits) {
  const TemporaryFolder folder;
  auto config = simulation::default_rig(8, "kitchen");
  config.profile.servo.kind = ServoKind::continuous;
  config.profile.servo.full_rate_dps = 220.0;
  SimulatedBus bus(config);
  const DrivenRun run = run_to_journal(bus, recording_options(folder, config.profile, short_plan()));
  ASSERT_FALSE(run.failure) << run.failure->what();
  EXPECT_EQ(complete_legs(run).size(), 4U);
}

TEST(Sweep, StopsTheServoOnRequestBeforeItEnds) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(9, "kitchen"));
  bus.rig.keep_truth(true);
  const DrivenRun run = run_to_journal(
      bus, recording_options(folder, simulation::default_profile(), short_plan()), {.stop_at_s = 3.0});
  EXPECT_TRUE(run.stopped);
  EXPECT_FALSE(run.failure);
  EXPECT_TRUE(run.raw.complete);
  EXPECT_TRUE(has_event(run.raw, EventKind::stopped));
  EXPECT_LT(to_s(run.end - HostTime{}), 4.0);
  bus.rig.advance(run.end + std::chrono::milliseconds(300));
  EXPECT_LT(std::abs(rate_at_end(bus)), 1.0);
  EXPECT_EQ(build_session(run.raw).state, session::State::partial);
  ASSERT_FALSE(run.raw.legs.empty());
  EXPECT_FALSE(run.raw.legs.back().complete);
}

TEST(Sweep, StopsTheServoWhenTheCameraIsLost) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(10, "kitchen"));
  bus.is_cut = [](Device device, HostTime at) {
    return device == Device::camera && to_s(at - HostTime{}) > 2.0;
  };
  const DrivenRun run =
      run_to_journal(bus, recording_options(folder, simulation::default_profile(), short_plan()));
  ASSERT_TRUE(run.failure);
  EXPECT_EQ(run.failure->code(), ExitCode::device_lost);
  EXPECT_THAT(run.failure->where(), ::testing::HasSubstr("camera"));
  EXPECT_TRUE(has_event(run.raw, EventKind::device_lost));
  const session::Session session = build_session(run.raw);
  EXPECT_EQ(session.servo.back().state.motion, ServoMotion::disarmed);
}

TEST(Sweep, SurvivesLostAndDoubledBytesOnTheWayToTheServo) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(11, "kitchen"));
  std::uint32_t random = 1;
  bus.to_servo = [&](const std::vector<std::uint8_t>& bytes, HostTime) {
    std::vector<std::uint8_t> damaged;
    for (const std::uint8_t byte : bytes) {
      random = random * 1664525U + 1013904223U;
      const std::uint32_t chance = random >> 22U;  // 0..1023
      if (chance != 0) damaged.push_back(byte);
      if (chance == 1) damaged.push_back(byte);
    }
    return damaged;
  };
  const SweepPlan plan = short_plan();
  const DrivenRun run = run_to_journal(bus, recording_options(folder, simulation::default_profile(), plan));
  ASSERT_FALSE(run.failure) << run.failure->what();
  EXPECT_EQ(complete_legs(run).size(), plan.leg_rates_dps.size());
}

}  // namespace
}  // namespace thermorig::rig::test

// SPDX-License-Identifier: MIT
// Devices that go and come back while a plan is driven, in virtual time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulated_bus.h"
#include "support/at_s.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<RecordingEvent> events_of(const RawRecording& raw, EventKind kind) {
  std::vector<RecordingEvent> found;
  for (const RecordingEvent& event : raw.events)
    if (event.kind == kind) found.push_back(event);
  return found;
}

/// The short plan on a rig whose cables are pulled, and what became of it.
struct PulledRig {
  explicit PulledRig(std::vector<simulation::Outage> unplugged, double patience_s = 60.0) {
    options.recording = recording_options(folder, simulation::default_profile(), short_plan());
    options.recording.replug_patience_s = patience_s;
    bus.unplugged = std::move(unplugged);
    options.progress_period = std::chrono::milliseconds(100);
    options.progress = [this](const RecordingProgress& now) { shown.push_back(now); };
  }
  void go() {
    result = record_virtual(bus, options);
    session = session::read_session(result.session);
  }
  std::vector<LegRecord> legs(bool complete) const {
    std::vector<LegRecord> found;
    for (const LegRecord& leg : session.raw.legs)
      if (leg.complete == complete) found.push_back(leg);
    return found;
  }

  TemporaryFolder folder;
  SimulatedBus bus{simulation::default_rig(4, "kitchen")};
  VirtualOptions options;
  std::vector<RecordingProgress> shown;
  RecordingResult result;
  session::Session session;
};

class EachDevice : public ::testing::TestWithParam<Device> {};
INSTANTIATE_TEST_SUITE_P(Devices, EachDevice, ::testing::ValuesIn(all_devices),
                         [](const auto& device) { return std::string(name_of(device.param)); });

TEST_P(EachDevice, ThatComesBackGoesOnAtTheStartOfTheInterruptedLeg) {
  const Device device = GetParam();
  PulledRig run({{device, at_s(3.5), at_s(8.0)}});
  run.go();
  EXPECT_EQ(run.result.state, session::State::complete) << run.result.message;
  EXPECT_THAT(run.result.message, HasSubstr("the " + std::string(name_of(device)) + " was away for "));
  EXPECT_TRUE(run.result.exit == ExitCode::ok || run.result.exit == ExitCode::finished_lossy);
  EXPECT_EQ(run.legs(true).size(), 4U);
  const auto cut = run.legs(false);
  ASSERT_EQ(cut.size(), 1U);
  const auto again =
      std::find_if(run.session.raw.legs.begin(), run.session.raw.legs.end(),
                   [&](const auto& leg) { return leg.step == cut[0].step && leg.leg != cut[0].leg; });
  ASSERT_NE(again, run.session.raw.legs.end());
  EXPECT_EQ(again->leg, cut[0].leg + 1);
  EXPECT_GT(again->begin, at_s(8.0));
}

TEST_P(EachDevice, ThatComesBackIsToldInEventsAndBeginsANewEpoch) {
  const Device device = GetParam();
  PulledRig run({{device, at_s(3.5), at_s(8.0)}});
  run.go();
  const auto lost = events_of(run.session.raw, EventKind::device_lost);
  const auto back = events_of(run.session.raw, EventKind::device_back);
  ASSERT_EQ(lost.size(), 1U);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(lost[0].source, device);
  EXPECT_EQ(back[0].source, device);
  EXPECT_THAT(lost[0].message, HasSubstr("waiting up to 60 s"));
  EXPECT_NEAR(to_s(lost[0].time - HostTime{}), 3.5, 0.02);
  EXPECT_GT(back[0].time, at_s(8.0));
  const auto& epochs = run.session.sync.clock[device].epochs;
  ASSERT_EQ(epochs.size(), 2U);
  EXPECT_THAT(epochs[1].reason, HasSubstr("was away for 4."));
}

TEST_P(EachDevice, ThatWasAwayLeavesNoValidFrameAndNoRunOverTheGap) {
  const Device device = GetParam();
  PulledRig run({{device, at_s(3.5), at_s(8.0)}});
  run.go();
  std::uint32_t run_before = 0, run_after = 0;
  for (const LabelledSample& sample : run.session.samples) {
    if (sample.exposure_end < at_s(3.5)) run_before = std::max(run_before, sample.run);
    if (sample.exposure_begin > at_s(8.0) && sample.run != 0 && run_after == 0) run_after = sample.run;
    const bool within = sample.exposure_end > at_s(3.6) && sample.exposure_begin < at_s(8.0);
    EXPECT_FALSE(within && sample.valid) << to_s(sample.time - HostTime{});
  }
  EXPECT_GT(run_before, 0U);
  EXPECT_GT(run_after, run_before);
}

TEST_P(EachDevice, ThatWasAwayIsReprocessedTheSame) {
  PulledRig run({{GetParam(), at_s(3.5), at_s(8.0)}});
  run.go();
  const session::Session again = build_session(session::read_raw(run.result.session));
  ASSERT_EQ(again.samples.size(), run.session.samples.size());
  for (std::size_t i = 0; i < again.samples.size(); ++i) {
    EXPECT_EQ(again.samples[i].time, run.session.samples[i].time);
    EXPECT_EQ(again.samples[i].reason_bits, run.session.samples[i].reason_bits);
  }
}

TEST_P(EachDevice, ThatStaysAwayEndsItAfterThePatience) {
  PulledRig run({{GetParam(), at_s(3.5), at_s(1000.0)}}, 7.0);
  run.go();
  EXPECT_EQ(run.result.exit, ExitCode::device_lost);
  EXPECT_THAT(run.result.message,
              AllOf(HasSubstr(std::string(name_of(GetParam()))), HasSubstr("did not come back within 7 s")));
  EXPECT_NEAR(run.result.duration_s, 3.5 + 7.0, 1.0);
  EXPECT_EQ(run.result.state, session::State::partial);
}

TEST_P(EachDevice, IsNotWaitedForWithoutPatience) {
  PulledRig run({{GetParam(), at_s(3.5), at_s(5.0)}}, 0.0);
  run.go();
  EXPECT_EQ(run.result.exit, ExitCode::device_lost);
  EXPECT_LT(run.result.duration_s, 5.0);
}

TEST_P(EachDevice, ThatIsAwaitedIsShownWithTheTimeThatIsLeft) {
  const Device device = GetParam();
  PulledRig run({{device, at_s(3.5), at_s(8.0)}}, 20.0);
  run.go();
  double least_left_s = 20.0;
  for (const RecordingProgress& progress : run.shown)
    if (const auto& awaited = progress.awaited[device]) {
      EXPECT_NEAR(awaited->waited_s + awaited->left_s, 20.0, 1e-6);
      EXPECT_EQ(progress.sweep.phase, SweepPhase::awaiting);
      least_left_s = std::min(least_left_s, awaited->left_s);
    }
  EXPECT_NEAR(least_left_s, 20.0 - 4.5, 1.5);
}

TEST_P(EachDevice, ThatIsAwaitedDoesNotHinderAStop) {
  PulledRig run({{GetParam(), at_s(3.5), at_s(1000.0)}});
  int steps = 0;
  run.options.stop_requested = [&] { return ++steps > 1500; };  // 6 s
  run.go();
  EXPECT_EQ(run.result.exit, ExitCode::interrupted) << run.result.message;
  EXPECT_LT(run.result.duration_s, 8.5);
}

TEST(Replugged, TheServoRestsWhileTheCameraIsAway) {
  PulledRig run({{Device::camera, at_s(3.5), at_s(8.0)}});
  run.go();
  for (const TimedServo& servo : run.session.servo)
    if (servo.stamp.time > at_s(3.9) && servo.stamp.time < at_s(8.0)) {
      EXPECT_EQ(servo.state.rate_dps, 0.0);
    }
}

TEST(Replugged, TwoDevicesAtOnceAreBothWaitedFor) {
  PulledRig run({{Device::camera, at_s(3.5), at_s(8.0)}, {Device::servo, at_s(3.6), at_s(11.0)}});
  run.go();
  EXPECT_EQ(run.result.state, session::State::complete) << run.result.message;
  EXPECT_THAT(run.result.message, AllOf(HasSubstr("the camera was away"), HasSubstr("the servo for")));
  EXPECT_EQ(run.legs(true).size(), 4U);
}

TEST(Replugged, AllThreeAtOnceAreWaitedFor) {
  PulledRig run({{Device::camera, at_s(3.5), at_s(8.0)},
                 {Device::gyro, at_s(3.5), at_s(7.0)},
                 {Device::servo, at_s(3.5), at_s(6.0)}});
  run.go();
  EXPECT_EQ(run.result.state, session::State::complete) << run.result.message;
  EXPECT_EQ(run.legs(true).size(), 4U);
}

TEST(Replugged, OneThatGoesTwiceIsWaitedForTwice) {
  PulledRig run({{Device::gyro, at_s(3.5), at_s(5.0)}, {Device::gyro, at_s(9.0), at_s(11.0)}});
  run.go();
  EXPECT_EQ(run.result.state, session::State::complete) << run.result.message;
  EXPECT_EQ(events_of(run.session.raw, EventKind::device_back).size(), 2U);
  EXPECT_EQ(run.session.sync.clock[Device::gyro].epochs.size(), 3U);
  EXPECT_THAT(run.result.message, HasSubstr("the gyro was away 2 times for "));
}

TEST(Replugged, OneWhosePlugIsLooseDoesNotHoldItUpForEver) {
  std::vector<simulation::Outage> loose;
  for (double s = 3.5; s < 120.0; s += 4.0) loose.push_back({Device::gyro, at_s(s), at_s(s + 1.0)});
  PulledRig run(loose);
  run.options.recording.plan.frames_per_leg = 40;  // no leg ends between
  run.go();
  EXPECT_EQ(run.result.exit, ExitCode::device_lost);
  EXPECT_THAT(run.result.message, HasSubstr("before a leg was finished"));
  EXPECT_LT(run.result.duration_s, 40.0);
}

TEST(Replugged, AnotherDeviceInItsPlaceIsNamed) {
  PulledRig run({{Device::camera, at_s(3.5), at_s(8.0)}});
  run.bus.from_device[index_of(Device::camera)] = [&](std::vector<std::uint8_t> bytes, HostTime now) {
    if (now < at_s(8.0)) return bytes;
    std::vector<std::uint8_t> packets;  // a WitMotion gyro at rest
    for (int i = 0; i < 4; ++i)
      for (const int byte : {0x55, 0x52, 0, 0, 0, 0, 0, 0, 0, 0, 0xA7})
        packets.push_back(static_cast<std::uint8_t>(byte));
    return packets;
  };
  run.go();
  EXPECT_EQ(run.result.exit, ExitCode::device_lost);
  EXPECT_THAT(run.result.message, HasSubstr("so it is the gyro, not the camera"));
  EXPECT_LT(run.result.duration_s, 20.0);
}

TEST(Replugged, AServoThatWentWhileItMovedIsArmedWhereItStands) {
  PulledRig run({{Device::servo, at_s(3.5), at_s(8.0)}});
  run.bus.rig.keep_truth(true);
  run.go();
  double fastest_dps = 0.0;
  for (const simulation::TruthSample& sample : run.bus.rig.shaft())
    if (sample.time > at_s(4.1) && sample.time < at_s(8.0))
      fastest_dps = std::max(fastest_dps, std::abs(sample.rate_dps));
  EXPECT_LT(fastest_dps, 1.0);
  // From its comeback to the next leg it does not jump.
  const auto next = std::find_if(run.session.raw.legs.begin(), run.session.raw.legs.end(),
                                 [](const LegRecord& leg) { return leg.begin > at_s(8.0); });
  ASSERT_NE(next, run.session.raw.legs.end());
  for (const simulation::TruthSample& sample : run.bus.rig.shaft())
    if (sample.time > at_s(8.0) && sample.time < next->begin - from_s(1.5)) {
      EXPECT_LT(std::abs(sample.rate_dps), 20.0) << to_s(sample.time - HostTime{});
    }
}

TEST(Replugged, BeforeTheRigWasReadyNothingIsWaitedFor) {
  PulledRig run({{Device::camera, at_s(0.05), at_s(8.0)}});
  EXPECT_THROW(run.go(), Error);
}

}  // namespace
}  // namespace thermorig::rig::test

// SPDX-License-Identifier: MIT
// What the hard table measures: it must see what is put into a session on purpose, no more and no less.
#include "bench/hard_truth.h"

#include <gtest/gtest.h>

#include <chrono>

#include "rig/simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::bench {
namespace {

using namespace std::chrono_literals;

/// A short recording in the honest world with its truth, made once for all tests; each changes a copy.
struct HonestRecording {
  HonestRecording() {
    bus.rig.keep_truth(true);
    const rig::test::TemporaryFolder folder;
    const auto options =
        rig::test::recording_options(folder, simulation::default_profile(), rig::test::short_plan());
    session = rig::build_session(rig::test::run_to_journal(bus, options).raw);
  }
  rig::test::SimulatedBus bus{simulation::default_rig(7, "kitchen")};
  session::Session session;
};

const HonestRecording& honest() {
  static const HonestRecording recording;
  return recording;
}

TEST(StatedBounds, HoldTheTruthUpToTheirEndsAndWhatIsGrantedBeyond) {
  Stamp stamp;
  stamp.time = HostTime(10s);
  stamp.earlier_s = 0.002F;
  stamp.later_s = 0.001F;
  EXPECT_FALSE(is_outside(stamp, HostTime(10s) - 1999us, 0.0));
  EXPECT_TRUE(is_outside(stamp, HostTime(10s) - 2010us, 0.0));
  EXPECT_FALSE(is_outside(stamp, HostTime(10s) + 999us, 0.0));
  EXPECT_TRUE(is_outside(stamp, HostTime(10s) + 1010us, 0.0));
  EXPECT_FALSE(is_outside(stamp, HostTime(10s) + 3999us, 0.003));
  EXPECT_TRUE(is_outside(stamp, HostTime(10s) + 4010us, 0.003));
}

TEST(LabelErrors, AreOfTheValidFramesWithinLegs) {
  const LabelErrors errors = label_errors(honest().session, honest().bus.rig);
  std::size_t frames = 0;
  std::size_t valid = 0;
  for (const LabelledSample& sample : honest().session.samples) {
    frames += sample.leg != 0;
    valid += sample.valid;
  }
  ASSERT_GT(valid, 0U);
  EXPECT_LT(valid, frames);
  EXPECT_EQ(errors.frames, frames);
  EXPECT_EQ(errors.shaft_dps.size(), valid);
  EXPECT_EQ(errors.uncertainty_dps.size(), valid);
  EXPECT_EQ(errors.commanded_dps.size(), valid);
}

TEST(LabelErrors, CountTheFramesThatTheWorldItselfMakesUseless) {
  const LabelErrors errors = label_errors(honest().session, honest().bus.rig);
  const std::size_t rejected = errors.frames - errors.shaft_dps.size();
  EXPECT_GT(errors.useless, 0U);  // ramps and reversals
  EXPECT_LE(errors.rejected_useless, std::min(errors.useless, rejected));
  EXPECT_LE(rejected - errors.rejected_useless, 1U);  // on the edge
  EXPECT_LE(errors.useless - errors.rejected_useless, 1U);
}

TEST(LabelErrors, GrowByWhatIsAddedToTheLabels) {
  const LabelErrors before = label_errors(honest().session, honest().bus.rig);
  session::Session session = honest().session;
  for (LabelledSample& sample : session.samples) {
    sample.rate_shaft_dps += 2.0F;
    sample.rate_commanded_dps -= 3.0F;
  }
  const LabelErrors after = label_errors(session, honest().bus.rig);
  ASSERT_EQ(after.shaft_dps.size(), before.shaft_dps.size());
  for (std::size_t i = 0; i < before.shaft_dps.size(); ++i) {
    EXPECT_NEAR(after.shaft_dps[i] - before.shaft_dps[i], 2.0, 1e-4);
    EXPECT_NEAR(after.commanded_dps[i] - before.commanded_dps[i], -3.0, 1e-4);
  }
}

TEST(LabelErrors, AreNoneForBytesThatTheCameraNeverSent) {
  session::Session session = honest().session;
  for (TimedFrame& frame : session.frames) ++frame.span.end;
  EXPECT_EQ(label_errors(session, honest().bus.rig).frames, 0U);
}

TEST(TimeErrors, OfTheHonestWorldLieWithinWhatIsStated) {
  // Not calibrated: what the latencies may be off by is stated, and wide.
  const auto errors = time_errors(honest().session, honest().bus.rig);
  for (const Device device : all_devices) {
    EXPECT_GT(errors[device].errors_s.size(), 0U) << name_of(device);
    EXPECT_EQ(errors[device].outside, 0U) << name_of(device);
  }
  EXPECT_EQ(errors[Device::servo].errors_s.size(), honest().session.servo.size());
}

TEST(TimeErrors, GrowByAShiftOfTheTimesAndLeaveTheBounds) {
  const auto before = time_errors(honest().session, honest().bus.rig);
  session::Session session = honest().session;
  for (TimedFrame& frame : session.frames) frame.stamp.time += 200ms;
  for (TimedGyro& sample : session.gyro) sample.stamp.time += 200ms;
  for (TimedServo& message : session.servo) message.stamp.time += 200ms;
  const auto after = time_errors(session, honest().bus.rig);
  for (const Device device : all_devices) {
    ASSERT_EQ(after[device].errors_s.size(), before[device].errors_s.size());
    EXPECT_NEAR(after[device].errors_s.front() - before[device].errors_s.front(), 0.2, 1e-6)
        << name_of(device);
    EXPECT_EQ(after[device].outside, after[device].errors_s.size()) << name_of(device);
  }
}

TEST(TimeErrors, AreGrantedThreeDeviationsOfTheLatency) {
  const auto errors = time_errors(honest().session, honest().bus.rig)[Device::servo].errors_s;
  session::Session session = honest().session;
  ASSERT_EQ(errors.size(), session.servo.size());
  session.sync.clock[Device::servo].latency_uncertainty_s = 0.002;
  const auto count_outside = [&](HostDuration late) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const HostTime truth = honest().session.servo[i].stamp.time - from_s(errors[i]);
      session.servo[i].stamp = {.time = truth + late};  // its own bounds have no width
    }
    return time_errors(session, honest().bus.rig)[Device::servo].outside;
  };
  EXPECT_EQ(count_outside(5990us), 0U);
  EXPECT_EQ(count_outside(6010us), errors.size());
}

TEST(TimeErrors, OfLateAndStaleFramesAreNotJudged) {
  const auto before = time_errors(honest().session, honest().bus.rig);
  session::Session session = honest().session;
  ASSERT_GT(session.frames.size(), 20U);
  const auto is_claimed = [](const TimedFrame& frame) { return !frame.late && !frame.stale; };
  ASSERT_TRUE(is_claimed(session.frames[10]));
  ASSERT_TRUE(is_claimed(session.frames[20]));
  session.frames[10].late = true;
  session.frames[20].stale = true;
  const auto after = time_errors(session, honest().bus.rig);
  EXPECT_EQ(after[Device::camera].errors_s.size() + 2, before[Device::camera].errors_s.size());
}

TEST(TrueGyroScale, IsTheSlopeOfTheRatesAgainstTheShaftWhateverTheBias) {
  const auto before = true_gyro_scale(honest().session, honest().bus.rig);
  session::Session session = honest().session;
  for (TimedGyro& sample : session.gyro) sample.rate_dps = 1.05F * sample.rate_dps + 4.0F;
  const auto after = true_gyro_scale(session, honest().bus.rig);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(*before, 1.0, 0.03);
  EXPECT_NEAR(*after, 1.05 * *before, 1e-5);
}

}  // namespace
}  // namespace thermorig::bench

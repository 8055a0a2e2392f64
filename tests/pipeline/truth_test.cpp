// SPDX-License-Identifier: MIT
// The simulated rig knows what the program must find out: labels against what its shaft really did.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>

#include "scripted_bytes.h"
#include "virtual_sweep.h"

namespace thermorig::pipeline {
namespace {

/// +100 deg/s, -200 deg/s and +30 deg/s for 6 s each.
VirtualSweep sweep_of(std::uint64_t seed, bool half_fresh) {
  auto config = simulation::default_rig(seed, "garden");
  config.half_fresh = half_fresh;
  return drive(config, {{2.0, 6.0, 100.0}, {9.0, 6.0, -200.0}, {16.0, 6.0, 30.0}}, 23.0);
}

Result second_pass(const VirtualSweep& sweep) {
  const Fits fits = first_pass(sweep.config.profile, sweep.chunks, sweep.sent);
  return run(sweep.config.profile, sweep.chunks, fits, sweep.sent);
}

class Truth : public testing::TestWithParam<bool> {};

TEST_P(Truth, FindsTheCamerasModeAndItsSlowClock) {
  const VirtualSweep sweep = sweep_of(3, GetParam());
  const Fits fits = first_pass(sweep.config.profile, sweep.chunks, sweep.sent);
  EXPECT_EQ(fits.camera_mode, GetParam() ? labels::CameraMode::half_fresh : labels::CameraMode::full_fresh);
  const double sent_s = to_s(sweep.frames.back().exposure_end - sweep.frames.front().exposure_end) /
                        static_cast<double>(sweep.frames.size() - 1);
  ASSERT_TRUE(fits.frame_period_s);
  EXPECT_NEAR(*fits.frame_period_s, sent_s, 0.0005);
  EXPECT_GT(*fits.frame_period_s, 0.126);  // 2 % slow: the nominal 0.125 s is wrong
}

/// As threads may do it: the last one first.
void backwards(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = count; i-- > 0;) work(i);
}

TEST_P(Truth, FitsAreTheSameInWhateverOrderTheyAreWorkedOut) {
  const VirtualSweep sweep = sweep_of(3, GetParam());
  const Fits one = first_pass(sweep.config.profile, sweep.chunks, sweep.sent);
  const Fits other = first_pass(sweep.config.profile, sweep.chunks, sweep.sent, backwards);
  ASSERT_TRUE(one.sync->gyro.scale_by_turns && one.sync->camera_offset.offset_s);
  EXPECT_EQ(*one.sync->gyro.scale_by_turns, *other.sync->gyro.scale_by_turns);
  EXPECT_EQ(*one.sync->camera_offset.offset_s, *other.sync->camera_offset.offset_s);
  EXPECT_EQ(one.sync->servo.scale, other.sync->servo.scale);
  EXPECT_EQ(one.sync->servo.delay_s, other.sync->servo.delay_s);
  for (const Device device : all_devices)
    EXPECT_EQ(one.times[device].back().time, other.times[device].back().time);
}

TEST_P(Truth, EveryFrameAndGyroSampleThatArrivedIsThereInOrder) {
  const VirtualSweep sweep = sweep_of(4, GetParam());
  const Result result = run(sweep.config.profile, sweep.chunks);
  EXPECT_EQ(result.samples.size(), result.streams.frames.size());
  EXPECT_GE(result.streams.frames.size() + 1, sweep.frames.size());  // the last may be on its way
  EXPECT_GE(result.streams.gyro.size() + 5, sweep.gyro.size());
  for (std::size_t i = 0; i < result.samples.size(); ++i) EXPECT_EQ(result.samples[i].frame_index, i);
  for (const Device device : all_devices) EXPECT_EQ(result.counters[device].bad_checksum, 0U);
}

/// The boards' latencies are not calibrated: the camera's is found against the gyro's, which stays as
/// uncertain as it is, 2 ms.
TEST_P(Truth, ExposuresLieWhereTheyWereAndAsWellAsIsSaid) {
  const VirtualSweep sweep = sweep_of(5, GetParam());
  const Fits fits = first_pass(sweep.config.profile, sweep.chunks, sweep.sent);
  const Result result = run(sweep.config.profile, sweep.chunks, fits, sweep.sent);
  const double latency_s = fits.sync->clock[Device::camera].latency_uncertainty_s;
  ASSERT_LT(latency_s, 0.003);
  std::size_t late = 0;
  for (const LabelledSample& sample : result.samples) {
    const auto& sent = sweep.frames.at(sample.frame_index);
    const TimedFrame& frame = result.streams.frames.at(sample.frame_index);
    if (frame.late) {
      ++late;
      continue;
    }
    const double stated_s = 3.0 * std::hypot(latency_s, double{frame.stamp.uncertainty_s});
    const double most_s = std::min(stated_s, 0.003);
    EXPECT_NEAR(to_s(sample.exposure_end - sent.exposure_end), 0.0, most_s) << sample.frame_index;
    EXPECT_NEAR(to_s(sample.exposure_begin - sent.exposure_begin), 0.0, most_s) << sample.frame_index;
  }
  EXPECT_LE(late, 2U);
}

TEST_P(Truth, ValidLabelsAreTheShaftsMeanSpeedAndAsGoodAsIsSaid) {
  std::size_t valid = 0, beyond_three = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const VirtualSweep sweep = sweep_of(seed, GetParam());
    std::set<std::uint16_t> legs;
    for (const LabelledSample& sample : second_pass(sweep).samples) {
      if (!sample.valid) continue;
      ++valid;
      legs.insert(sample.leg);
      const double shaft_dps = sweep.frames.at(sample.frame_index).mean_rate_dps;
      const double error_dps = std::abs(double{sample.rate_shaft_dps} - shaft_dps);
      EXPECT_LT(error_dps, 0.75) << sample.frame_index;
      beyond_three += !(error_dps <= 3.0 * double{sample.rate_shaft_uncertainty_dps});
    }
    EXPECT_EQ(legs.size(), 3U);
  }
  EXPECT_GT(valid, 380U);
  EXPECT_LE(beyond_three, valid / 40);  // 23 s tell little of the loop's ripple: not quite normal
}

TEST_P(Truth, RestsAndRampsAreNeverValid) {
  const VirtualSweep sweep = sweep_of(6, GetParam());
  for (const LabelledSample& sample : second_pass(sweep).samples) {
    const double end_s = to_s(sweep.frames.at(sample.frame_index).exposure_end.time_since_epoch());
    const bool at_rest = end_s < 2.0 || (end_s > 8.5 && end_s < 9.0) || end_s > 22.5;
    if (at_rest) {
      EXPECT_FALSE(sample.valid) << end_s;
      EXPECT_EQ(sample.run, 0U);
    }
  }
}

/// Frames whose end of exposure lies outside the stated bounds, with three deviations of the latency on
/// either side.
std::size_t frames_outside(const VirtualSweep& sweep, const Result& result, double latency_uncertainty_s) {
  const double latency_s = 3.0 * latency_uncertainty_s;
  std::size_t outside = 0;
  for (const LabelledSample& sample : result.samples) {
    const TimedFrame& frame = result.streams.frames.at(sample.frame_index);
    const auto& sent = sweep.frames.at(sample.frame_index);
    if (frame.late || frame.stale) continue;
    const double later_s = to_s(sent.exposure_end - frame.stamp.time);
    outside += later_s > latency_s + double{frame.stamp.later_s} ||
               -later_s > latency_s + double{frame.stamp.earlier_s};
  }
  return outside;
}

/// The bridge's firmware, how rows are read and how slow the membranes are: nothing tells it of a rig at rest
/// that was never calibrated.
TEST(TruthAtRest, AnUncalibratedCamerasTimesLieWithinWhatIsStatedInAnyWorld) {
  for (const char* world : {"typical", "hard"}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      auto config = simulation::default_rig(seed, "laboratory");
      simulation::put_in_world(simulation::world_named(world, seed), config);
      config.world.camera.lost_subpages = config.world.camera.repeated_frames = 0.0;  // index is index
      const VirtualSweep sweep = drive(config, {}, 12.0);
      const Fits fits = first_pass(sweep.config.profile, sweep.chunks, sweep.sent);
      const Result result = run(sweep.config.profile, sweep.chunks, fits, sweep.sent);
      ASSERT_GT(result.samples.size(), 80U);
      const double stated_s = fits.sync->clock[Device::camera].latency_uncertainty_s;
      EXPECT_EQ(frames_outside(sweep, result, stated_s), 0U) << world << seed;
      EXPECT_LT(stated_s, 0.040);  // no hiding behind a wide band
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, Truth, testing::Bool(), [](const testing::TestParamInfo<bool>& mode) {
  return std::string(mode.param ? "HalfFresh" : "FullFresh");
});

}  // namespace
}  // namespace thermorig::pipeline

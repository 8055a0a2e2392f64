// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "scripted_bytes.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::pipeline {
namespace {

constexpr HostTime gone{};

HostTime later(double seconds) {
  return gone + from_s(seconds);
}

/// A pipeline whose camera, of 8 frames a second unless another rate is given, has been missing from `gone`.
struct WithoutCamera {
  explicit WithoutCamera(double rate_hz = 8.0) : pipeline(profile_of(rate_hz)) {
    pipeline.stand_in_for_camera(gone);
  }

  static RigProfile profile_of(double rate_hz) {
    RigProfile profile = simulation::default_profile();
    profile.camera.output_rate_hz = rate_hz;
    return profile;
  }

  std::vector<TimedFrame> frames_until(HostTime now) {
    pipeline.feed(Device::gyro, {}, now);
    return pipeline.take_streams().stand_ins;
  }

  Pipeline pipeline;
};

TEST(AnAbsentCamera, HasAFrameEachPeriodOnceThoseBeforeHaveTheirLabels) {
  WithoutCamera rig;
  EXPECT_TRUE(rig.frames_until(later(1.6)).empty());
  EXPECT_FALSE(rig.pipeline.stands_in_for_camera());
  const auto frames = rig.frames_until(later(2.7));
  EXPECT_TRUE(rig.pipeline.stands_in_for_camera());
  ASSERT_EQ(frames.size(), 9U);
  EXPECT_EQ(frames[0].missing_before, 1);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].missing_before, 0);
    EXPECT_EQ(frames[i].exposure_end - frames[i - 1].exposure_end, std::chrono::milliseconds(125));
  }
}

TEST(AnAbsentCamera, OfAHostThatSleptLeavesOutWhatLiesFarBack) {
  WithoutCamera rig;
  const auto awake = rig.frames_until(later(2.7));
  const auto after = rig.frames_until(later(2.7 + 3600.0));
  ASSERT_FALSE(after.empty());
  EXPECT_LE(after.size(), 41U);  // of five seconds
  EXPECT_NEAR(after.front().missing_before, 3595 * 8, 2);
  EXPECT_EQ((after.front().exposure_end - awake.back().exposure_end) / std::chrono::milliseconds(125),
            after.front().missing_before + 1);
  for (std::size_t i = 1; i < after.size(); ++i) EXPECT_EQ(after[i].missing_before, 0);
  EXPECT_LE(later(2.7 + 3600.0) - after.back().exposure_end, std::chrono::milliseconds(125));
}

TEST(AnAbsentCamera, OfARateThatNoCameraHasStaysSmall) {
  WithoutCamera rig(1e6);
  const auto frames = rig.frames_until(later(1e9));
  EXPECT_LE(frames.size(), 321U);
  EXPECT_EQ(frames.front().missing_before, 65535);  // as many as can be told
  EXPECT_LE(rig.pipeline.finish().size(), frames.size());
}

/// A sweep whose camera goes after 2 s; what it sends when it is back is nobody's any more.
std::vector<Measurement> measured_without_camera_from(HostTime since) {
  const ScriptedRecording recording(8.0);
  Pipeline pipeline(recording.profile);
  std::vector<Measurement> all;
  const auto keep = [&](std::vector<Measurement> some) { all.insert(all.end(), some.begin(), some.end()); };
  bool is_gone = false;
  for (const Chunk& chunk : chunks_within_messages(recording, 1000)) {
    if (!is_gone && chunk.arrived > since) {
      is_gone = true;
      keep(pipeline.interrupt(Device::camera, since));
      pipeline.stand_in_for_camera(since);
    }
    const bool is_away = chunk.device == Device::camera && is_gone && chunk.arrived < since + from_s(2.5);
    if (!is_away) keep(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived));
  }
  keep(pipeline.finish());
  return all;
}

TEST(AnAbsentCamera, IsStoodInForByFramesWithoutAnImageThatHaveLabelsAndFollowTheRealOnes) {
  const auto measurements = measured_without_camera_from(HostTime(from_s(2.0)));
  std::size_t real = 0, made = 0, valid = 0;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const auto& [frame, sample, gyro, servo] = measurements[i];
    EXPECT_EQ(sample.frame_index, i);
    EXPECT_EQ(sample.exposure_end, frame.exposure_end);
    EXPECT_EQ(frame.stands_in, std::isnan(frame.frame.temp_c[0]));
    EXPECT_TRUE(frame.stands_in || made == 0) << "a frame of the camera that is back, at " << i;
    ++(frame.stands_in ? made : real);
    valid += frame.stands_in && sample.valid ? 1 : 0;
  }
  EXPECT_GT(real, 10U);
  EXPECT_GT(made, 30U);
  EXPECT_LT(valid, made);  // the leg ends at 4 s
}

}  // namespace
}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#include "thermorig/rig/absent_camera.h"

#include <gtest/gtest.h>

#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::rig {
namespace {

constexpr HostTime since{};

HostTime at(double seconds) {
  return since + from_s(seconds);
}

TEST(AnAbsentCamera, HasAFrameEachPeriodOnceThoseBeforeHaveTheirLabels) {
  AbsentCamera camera(simulation::default_profile(), since);  // 8 Hz
  camera.add({}, at(1.6), 0);
  EXPECT_FALSE(camera.has_begun());
  camera.add({}, at(2.7), 0);
  const auto frames = camera.take_frames();
  ASSERT_EQ(frames.size(), 9U);
  EXPECT_EQ(frames[0].missing_before, 1);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].missing_before, 0);
    EXPECT_EQ(frames[i].exposure_end - frames[i - 1].exposure_end, std::chrono::milliseconds(125));
  }
}

TEST(AnAbsentCamera, OfAHostThatSleptLeavesOutWhatLiesFarBack) {
  AbsentCamera camera(simulation::default_profile(), since);
  camera.add({}, at(2.7), 0);
  const auto awake = camera.take_frames();
  camera.add({}, at(2.7 + 3600.0), 0);
  const auto after = camera.take_frames();
  ASSERT_FALSE(after.empty());
  EXPECT_LE(after.size(), 41U);  // of five seconds
  EXPECT_NEAR(after.front().missing_before, 3595 * 8, 2);
  EXPECT_EQ((after.front().exposure_end - awake.back().exposure_end) / std::chrono::milliseconds(125),
            after.front().missing_before + 1);
  for (std::size_t i = 1; i < after.size(); ++i) EXPECT_EQ(after[i].missing_before, 0);
  EXPECT_LE(at(2.7 + 3600.0) - after.back().exposure_end, std::chrono::milliseconds(125));
}

TEST(AnAbsentCamera, OfARateThatNoCameraHasStaysSmall) {
  RigProfile profile = simulation::default_profile();
  profile.camera.output_rate_hz = 1e6;
  AbsentCamera camera(profile, since);
  camera.add({}, at(1e9), 0);
  const auto frames = camera.take_frames();
  EXPECT_LE(frames.size(), 321U);
  EXPECT_EQ(frames.front().missing_before, 65535);  // as many as can be told
  EXPECT_LE(camera.take_pairs().size(), frames.size());
}

}  // namespace
}  // namespace thermorig::rig

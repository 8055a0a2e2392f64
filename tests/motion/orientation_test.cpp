// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "thermorig/fit/motion/panorama_fit.h"
#include "turning_rig.h"

namespace thermorig::motion {
namespace {

TEST(Orientation, IsRightInEverySeedIndoorsToo) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    config.profile.camera.mirrored = seed % 3 != 0;
    config.half_fresh = seed % 5 != 0;
    const Turning turning = turn(config, back_and_forth(80.0, 3.0, 24.0), 24.0);
    const Orientation found = orientation(turning.frames, turning.gyro, {}, turning.errors);
    ASSERT_TRUE(found.mirrored) << seed << ": " << found.why_not;
    EXPECT_EQ(*found.mirrored, config.profile.camera.mirrored) << seed;
    EXPECT_GT(found.contrast, 0.02);
    EXPECT_LE(found.contrast, 1.0);
  }
}

TEST(Orientation, OneDirectionOfTurningIsEnough) {
  const Turning turning = turn(simulation::default_rig(2, "dining"), {{2.0, 12.0, 70.0}}, 16.0);
  const Orientation found = orientation(turning.frames, turning.gyro, {55.0, false}, turning.errors);
  ASSERT_TRUE(found.mirrored) << found.why_not;
  EXPECT_TRUE(*found.mirrored);
}

TEST(Orientation, IsToldBeforeTheOrderOfTheHalvesIs) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    config.half_fresh = false;
    Turning turning = turn(config, back_and_forth(80.0, 3.0, 24.0), 24.0);
    for (TimedFrame& frame : turning.frames) frame.half.fill({frame.exposure_begin, frame.exposure_end});
    const Orientation found = orientation(turning.frames, turning.gyro, {}, turning.errors);
    ASSERT_TRUE(found.mirrored) << seed << ": " << found.why_not;
    EXPECT_TRUE(*found.mirrored) << seed;
  }
}

TEST(Orientation, FollowsTheGyrosSign) {
  Turning turning = turn(simulation::default_rig(3, "garden"), back_and_forth(80.0, 3.0, 24.0), 24.0);
  for (TimedGyro& sample : turning.gyro) sample.rate_dps = -sample.rate_dps;
  turning.errors.bias_dps->value *= -1.0;
  const Orientation found = orientation(turning.frames, turning.gyro, {}, turning.errors);
  ASSERT_TRUE(found.mirrored) << found.why_not;
  EXPECT_FALSE(*found.mirrored);
}

TEST(Orientation, IsNotToldAtRestNorBeforeABlindWall) {
  const auto config = simulation::default_rig(1, "laboratory");
  const Turning still = turn(config, {}, 12.0);
  const Orientation resting = orientation(still.frames, still.gyro, {}, still.errors);
  EXPECT_FALSE(resting.mirrored);
  EXPECT_NE(resting.why_not.find("while the rig turned"), std::string::npos) << resting.why_not;
  Turning wall = turn(config, back_and_forth(80.0, 3.0, 24.0), 24.0);
  make_wall(wall, 0.6F);
  const Orientation blind = orientation(wall.frames, wall.gyro, {}, wall.errors);
  EXPECT_FALSE(blind.mirrored);
  EXPECT_NE(blind.why_not.find("too little image detail"), std::string::npos) << blind.why_not;
}

TEST(NewerHalf, IsRightInEverySeed) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    auto config = simulation::default_rig(seed, environment_of(seed));
    config.half_fresh = false;
    const Turning turning = turn(config, back_and_forth(80.0, 3.0, 24.0), 24.0);
    const auto found = newer_half(turning.frames, turning.gyro, {}, turning.errors);
    ASSERT_TRUE(found) << seed;
    EXPECT_EQ(*found, turning.newer_half) << seed;
  }
}

TEST(NewerHalf, IsNotAskedOfHalfFreshFramesNorToldAtRest) {
  auto config = simulation::default_rig(1, "garden");
  const Turning half_fresh = turn(config, back_and_forth(80.0, 3.0, 22.0), 22.0);
  EXPECT_FALSE(newer_half(half_fresh.frames, half_fresh.gyro, {}, half_fresh.errors));
  config.half_fresh = false;
  const Turning still = turn(config, {}, 12.0);
  EXPECT_FALSE(newer_half(still.frames, still.gyro, {}, still.errors));
}

}  // namespace
}  // namespace thermorig::motion

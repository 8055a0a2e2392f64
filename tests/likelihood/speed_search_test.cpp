// SPDX-License-Identifier: MIT
#include "estimators/likelihood/speed_search.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace thermorig::likelihood {
namespace {

/// Halves of what stands still, a wave along the rows, under noise of variance 1.
SpeedPosterior alone(SpeedSearch& search, float contrast, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise;
  std::array<HalfLines, 4> halves;
  std::array<const HalfLines*, 4> pointers{};
  for (std::size_t half = 0; half < halves.size(); ++half) {
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t pixel = 0; pixel < line_pixels; ++pixel) {
        const std::size_t column = 2 * pixel + ((row + half) & 1U);
        halves[half][row][pixel] = contrast * std::sin(0.5F * static_cast<float>(column)) + noise(random);
      }
    pointers[half] = &halves[half];
  }
  WindowLines lines(halves.size());
  lines.set(0, pointers);
  return search.search(lines, 1.0, 15.0);
}

TEST(SpeedSearches, OfNoiseSayWhatIsExpected) {
  SpeedSearch search;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const SpeedPosterior before = alone(search, 0.0F, seed);
    const SpeedPosterior after = search.expecting({.speed = 5.0, .width = 0.3});
    EXPECT_LT(std::abs(after.speed - 5.0), std::abs(before.speed - 5.0)) << seed;
    EXPECT_LT(after.sigma, before.sigma) << seed;
  }
}

TEST(SpeedSearches, SayWhatIsSeenWhateverIsExpected) {
  SpeedSearch search;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const SpeedPosterior before = alone(search, 3.0F, seed);
    const SpeedPosterior after = search.expecting({.speed = 5.0, .width = 0.3});
    EXPECT_LT(before.sigma, 0.2);
    EXPECT_NEAR(after.speed, before.speed, 0.5 * before.sigma) << seed;
    EXPECT_NEAR(after.sigma, before.sigma, 0.2 * before.sigma) << seed;
  }
}

}  // namespace
}  // namespace thermorig::likelihood

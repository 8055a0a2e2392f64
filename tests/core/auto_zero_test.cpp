// SPDX-License-Identifier: MIT
#include "thermorig/core/auto_zero.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thermorig {
namespace {

constexpr float count_dps = 2000.0F / 32768.0F;  // WitMotion's

/// Samples of a gyro at rest, in whole steps.
void add_rest(AutoZero& zeros, int samples, float bias_dps, float noise_dps, float step_dps, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(bias_dps, noise_dps);
  const auto read = [&] { return step_dps * std::round(noise(random) / step_dps); };
  for (int i = 0; i < samples; ++i) zeros.add({read(), read(), read()});
}

void add_zeros(AutoZero& zeros, std::size_t samples) {
  for (std::size_t i = 0; i < samples; ++i) zeros.add({0.0F, -0.0F, 0.0F});
}

TEST(AutoZero, IsSeenWhereAGyroGoesToZeroAndStaysThere) {
  AutoZero zeros;
  add_rest(zeros, 500, -1.47F, 0.07F, count_dps, 1);
  EXPECT_FALSE(zeros.is_seen());
  add_zeros(zeros, 1000);
  EXPECT_TRUE(zeros.is_seen());
  EXPECT_EQ(zeros.longest(), 1000U);
}

TEST(AutoZero, IsSeenWhereThereIsNothingButZeros) {
  AutoZero zeros;
  add_zeros(zeros, AutoZero::fewest_zeros - 1);
  EXPECT_FALSE(zeros.is_seen());
  add_zeros(zeros, 1);
  EXPECT_TRUE(zeros.is_seen());
}

TEST(AutoZero, IsNotTheNoiseOfAGyroWithoutABias) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    AutoZero zeros;
    add_rest(zeros, 5000, 0.0F, 0.05F, count_dps, seed);
    EXPECT_FALSE(zeros.is_seen()) << seed << ": " << zeros.longest();
  }
}

TEST(AutoZero, IsNotToldOfReadingsTooCoarseForAnyNoise) {
  AutoZero zeros;
  add_rest(zeros, 5000, 0.0F, 0.3F, 1.0F, 2);
  add_zeros(zeros, 1000);
  EXPECT_FALSE(zeros.is_seen());
}

TEST(AutoZero, ReachesOverNoPause) {
  AutoZero zeros;
  for (int i = 0; i < 10; ++i) {
    add_zeros(zeros, AutoZero::fewest_zeros / 2);
    zeros.pause();
  }
  EXPECT_FALSE(zeros.is_seen());
}

}  // namespace
}  // namespace thermorig

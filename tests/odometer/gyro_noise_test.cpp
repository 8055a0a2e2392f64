// SPDX-License-Identifier: MIT
#include "estimators/odometer/gyro_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace thermorig::odometer {
namespace {

constexpr double period_s = 0.005;

/// A minute of a shaft that turns to and fro, by a gyro with white noise in each sample.
GyroNoise after_a_minute(double noise_dps, double swing_dps) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, noise_dps);
  GyroNoise found(period_s);
  for (int i = 0; i < 12000; ++i) {
    const double shaft_dps = swing_dps * std::sin(0.5 * i * period_s);
    found.add(shaft_dps + noise(random), period_s, i > 0);
  }
  return found;
}

TEST(GyroNoise, IsWhatItsAngleWalksAwayBy) {
  for (const double noise_dps : {0.3, 1.0, 3.0})
    EXPECT_NEAR(after_a_minute(noise_dps, 0.0).walk_deg2(), noise_dps * noise_dps * period_s,
                0.3 * noise_dps * noise_dps * period_s);
}

TEST(GyroNoise, IsHardlyMadeBySlowTurns) {
  EXPECT_LT(after_a_minute(0.1, 200.0).walk_deg2(), 4.0 * 0.1 * 0.1 * period_s);
}

TEST(GyroNoise, IsNoLargerThanGearsMakeIt) {
  EXPECT_LT(after_a_minute(100.0, 0.0).walk_deg2(), 0.1);
}

}  // namespace
}  // namespace thermorig::odometer

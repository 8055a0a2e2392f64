// SPDX-License-Identifier: MIT
#include "estimators/odometer/gyro_noise.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace thermorig::odometer {
namespace {

constexpr double step_s = 0.005, shaken_dps = 2.5;

/// Of ten seconds of a gyro whose z turns with the shaft.
double walk_deg2(double across_dps, double jerks_dps) {
  GyroNoise noise(2);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    TimedGyro sample;
    sample.rate_dps = static_cast<float>(50.0 + jerks_dps * normal(random));
    sample.reading.rate_dps = {static_cast<float>(1.0 + across_dps * normal(random)),
                               static_cast<float>(-2.0 + across_dps * normal(random)), sample.rate_dps};
    noise.add(sample, step_s);
  }
  return noise.walk_deg2();
}

TEST(GyroNoise, HearsAcrossTheShaftHowFarTheAngleWalks) {
  const double wanted_deg2 = shaken_dps * shaken_dps * step_s;
  EXPECT_NEAR(walk_deg2(shaken_dps, shaken_dps), wanted_deg2, 0.5 * wanted_deg2);
}

TEST(GyroNoise, TakesJerksOfTheServoForNoNoise) {
  EXPECT_LT(walk_deg2(0.0, 20.0), 1e-9);
}

TEST(GyroNoise, BearsBrokenReadings) {
  GyroNoise noise(2);
  for (int i = 0; i < 1000; ++i) {
    TimedGyro sample;
    sample.reading.rate_dps.fill(i % 70 == 3 ? std::numeric_limits<float>::quiet_NaN() : 1e30F);
    noise.add(sample, step_s);
  }
  EXPECT_LT(noise.walk_deg2(), 3.0);
}

}  // namespace
}  // namespace thermorig::odometer

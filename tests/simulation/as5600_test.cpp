// SPDX-License-Identifier: MIT
#include "simulation/as5600.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace thermorig::simulation {
namespace {

constexpr RegisterWrite fast_filter{0x07, 0x07};

double raw_deg(const SensorRegisters& registers) {
  return registers.raw * 360.0 / 4096.0;
}

/// Its angles, turns counted, while the shaft goes from 0 to `degrees`; sampled at each whole degree.
std::vector<double> turned(As5600& sensor, int degrees) {
  std::vector<double> angles;
  for (int angle = 0; angle < degrees; ++angle) {
    double now = raw_deg(sensor.look(Shaft(angle)));
    if (!angles.empty()) now += 360.0 * std::round((angles.back() - now) / 360.0);
    angles.push_back(now);
  }
  return angles;
}

TEST(As5600, FollowsTheShaftOrRunsAgainstIt) {
  bool with = false, against = false;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    As5600 sensor({.once_deg = 0.0, .twice_deg = 0.0}, seed);
    const auto angles = turned(sensor, 90);
    const double turn = angles.back() - angles.front();
    EXPECT_NEAR(std::abs(turn), 89.0, 0.3);
    (turn > 0.0 ? with : against) = true;
  }
  EXPECT_TRUE(with && against);
}

TEST(As5600, AMagnetOffTheAxisErrsOnceATurn) {
  As5600 sensor({.once_deg = 2.0, .twice_deg = 0.0}, 1);
  const auto angles = turned(sensor, 361);
  const double sign = angles.back() > angles.front() ? 1.0 : -1.0;
  double least = 0.0, most = 0.0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double error = angles[i] - angles.front() - sign * static_cast<double>(i);
    least = std::min(least, error);
    most = std::max(most, error);
  }
  EXPECT_NEAR(most - least, 4.0, 0.3);
  EXPECT_NEAR(std::abs(angles.back() - angles.front()), 360.0, 0.3);
}

TEST(As5600, NoiseIsThatOfItsSlowFilter) {
  const auto noise_deg = [](bool is_set_up) {
    As5600 sensor({}, 2);
    if (is_set_up) sensor.take(std::span(&fast_filter, 1));
    const Shaft still(10.0);
    const double mean_deg = raw_deg(sensor.look(still));
    double squares = 0.0;
    for (int i = 0; i < 4000; ++i) squares += std::pow(raw_deg(sensor.look(still)) - mean_deg, 2);
    return std::sqrt(squares / 4000.0);
  };
  EXPECT_LT(noise_deg(false), noise_deg(true));
}

TEST(As5600, WorstHabitsShowInItsBusAndStatus) {
  As5600 failing({.failed_reads = 0.05}, 3), weak({.weak_magnet = 1.0}, 3);
  int silent = 0, high = 0;
  for (int i = 0; i < 2000; ++i) {
    const SensorBus bus = failing.look(Shaft(0.0)).bus;
    silent += bus == SensorBus::silent;
    high += bus == SensorBus::hangs_high;
  }
  EXPECT_NEAR(silent, 50, 25);
  EXPECT_NEAR(high, 50, 25);
  EXPECT_EQ(weak.look(Shaft(0.0)).status, 0x30);
  EXPECT_EQ(register_byte({.bus = SensorBus::hangs_high}, 0x0C), 0xFF);
}

}  // namespace
}  // namespace thermorig::simulation

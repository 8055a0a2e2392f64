// SPDX-License-Identifier: MIT
#include "simulation/clock_wander.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation/servo_side.h"

namespace thermorig::simulation {
namespace {

constexpr WanderLevel level{.thermal_amplitude = 15e-6, .walk = 0.4e-6};

/// Mean rates over ten seconds each, in parts per million.
std::vector<double> rates_ppm(std::uint64_t seed, double seconds) {
  ClockWander wander(level, seed, "test");
  std::vector<double> rates;
  for (double s = 0.0; s < seconds; s += 10.0)
    rates.push_back(1e6 * ((wander.clock_ns((s + 10.0) * 1e9) - wander.clock_ns(s * 1e9)) / 10e9 - 1.0));
  return rates;
}

TEST(ClockWander, GoesForwardOnlyAndBackToTheSameInstantFor10000Seconds) {
  ClockWander wander(level, 3, "test");
  double before_ns = wander.clock_ns(-5e9);
  for (double rig_ns = -4.9e9; rig_ns < 1e13; rig_ns += 1.234567e8) {
    const double clock_ns = wander.clock_ns(rig_ns);
    ASSERT_GT(clock_ns, before_ns);
    ASSERT_NEAR(wander.rig_ns(clock_ns), rig_ns, 0.1);
    before_ns = clock_ns;
  }
}

TEST(ClockWander, DoesNotDependOnWhatWasAskedBefore) {
  ClockWander late(level, 3, "test"), early(level, 3, "test");
  const double last = late.clock_ns(5e12);
  for (double rig_ns = 0.0; rig_ns < 5e12; rig_ns += 7.7e9) early.rig_ns(early.clock_ns(rig_ns));
  EXPECT_EQ(early.clock_ns(5e12), last);
  EXPECT_EQ(late.clock_ns(1.5e9), early.clock_ns(1.5e9));
}

TEST(ClockWander, StraysByTensOfPartsPerMillionInMinutesAndNeverRunsAway) {
  double widest_ppm = 0.0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    const auto minutes = rates_ppm(seed, 900.0);
    const auto [low, high] = std::minmax_element(minutes.begin(), minutes.end());
    EXPECT_GT(*high - *low, 20.0) << seed;
    for (const double rate : rates_ppm(seed, 10'000.0)) widest_ppm = std::max(widest_ppm, std::abs(rate));
  }
  EXPECT_LT(widest_ppm, 60.0);
}

TEST(ClockWander, DiffersBySeed) {
  EXPECT_NE(rates_ppm(1, 100.0), rates_ppm(2, 100.0));
}

TEST(McuClock, ReadsTheMicrosecondAtTheInstantAtWhichItBegins) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    McuClock clock(seed);
    for (std::int64_t us = 1; us < 10'000'000'000; us = us * 5 / 4 + 1'234'567) {
      const std::int64_t rig_ns = clock.rig_ns_at(static_cast<double>(us));
      ASSERT_EQ(clock.us_at(rig_ns), us);
      ASSERT_EQ(clock.us_at(rig_ns - 1), us - 1);
    }
  }
}

TEST(McuClock, WandersByAFewPartsPerMillion) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    McuClock clock(seed);
    std::vector<double> rates_ppm;
    for (std::int64_t s = 0; s < 2000; s += 10)
      rates_ppm.push_back(
          static_cast<double>(clock.us_at((s + 10) * 1'000'000'000) - clock.us_at(s * 1'000'000'000)) / 10.0 -
          1e6);
    const auto [low, high] = std::minmax_element(rates_ppm.begin(), rates_ppm.end());
    EXPECT_GT(*high - *low, 8.0) << seed;
    EXPECT_LT(*high - *low, 30.0) << seed;
  }
}

}  // namespace
}  // namespace thermorig::simulation

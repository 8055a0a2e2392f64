// SPDX-License-Identifier: MIT
// What each of the servo's knobs does to its shaft.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "driven_plant.h"
#include "frame_statistics.h"

namespace thermorig::simulation {
namespace {

Motion driven(const ServoWorld& world, const Width& width_us, double seconds) {
  ServoPlant plant(winch(), 8.0, 1, world);
  return drive(plant, width_us, seconds);
}

Width sweep_at(double rate_dps) {
  return [rate_dps](double time_s) { return width_of(rate_dps * time_s); };
}

/// Up to `turn_s`, then back.
Width there_and_back(double rate_dps, double turn_s) {
  return [=](double time_s) { return width_of(rate_dps * (turn_s - std::abs(time_s - turn_s))); };
}

Width step_to(double angle_deg) {
  return [=](double time_s) { return width_of(time_s < 1.0 ? 0.0 : angle_deg); };
}

double overshoot_deg(double damping) {
  const Motion motion = driven({.damping = damping}, step_to(20.0), 3.0);
  return quantile_of(motion.angle_deg, 1.0) - motion.angle_at(2.9);
}

TEST(ServoWorld, OvershootsWithLittleDampingAndNotWithMuch) {
  EXPECT_GT(overshoot_deg(0.3), 3.0);
  EXPECT_LT(overshoot_deg(1.2), 0.1);
}

TEST(ServoWorld, LeavesTheShaftBehindByItsBacklashOnReversal) {
  const Motion tight = driven({}, there_and_back(60.0, 2.0), 4.0);
  const Motion worn = driven({.backlash_deg = 3.0}, there_and_back(60.0, 2.0), 4.0);
  EXPECT_NEAR(worn.angle_at(1.5) - tight.angle_at(1.5), -1.5, 0.02);
  EXPECT_NEAR(worn.angle_at(3.5) - tight.angle_at(3.5), 1.5, 0.02);
  double longest_rest_s = 0.0, rest_s = 0.0;
  for (double time_s = 1.9; time_s < 2.4; time_s += step_s) {
    rest_s = worn.rate_at(time_s) == 0.0 ? rest_s + step_s : 0.0;
    longest_rest_s = std::max(longest_rest_s, rest_s);
  }
  EXPECT_NEAR(longest_rest_s, 0.08, 0.05);  // 3 deg at up to 60 deg/s
}

double share_at_rest(const Motion& motion, double from_s, double to_s) {
  const auto rates = motion.rates_between(from_s, to_s);
  const auto at_rest =
      std::count_if(rates.begin(), rates.end(), [](double rate) { return std::abs(rate) < 1.0; });
  return static_cast<double>(at_rest) / static_cast<double>(rates.size());
}

TEST(ServoWorld, SticksAndSlipsWhereItIsSlow) {
  EXPECT_EQ(share_at_rest(driven({}, sweep_at(20.0), 4.0), 2.0, 4.0), 0.0);
  EXPECT_GT(share_at_rest(driven({.stick_deg = 2.5}, sweep_at(20.0), 4.0), 2.0, 4.0), 0.1);
  EXPECT_EQ(share_at_rest(driven({.stick_deg = 2.5}, sweep_at(100.0), 4.0), 2.0, 4.0), 0.0);
}

TEST(ServoWorld, LagsByItsColdFrictionUntilItIsWarm) {
  const auto lag_deg = [](double time_s) {
    const Width slowly = [](double at_s) { return width_of(3.0 * at_s); };
    return driven({}, slowly, time_s + 0.1).angle_at(time_s) -
           driven({.cold_friction_deg = 2.0}, slowly, time_s + 0.1).angle_at(time_s);
  };
  EXPECT_NEAR(lag_deg(4.0), 2.0, 0.3);
  EXPECT_NEAR(lag_deg(250.0), 2.0 * std::exp(-250.0 / 120.0), 0.3);
}

TEST(ServoWorld, IgnoresMoreWithinAWiderDeadBand) {
  const Width back_by_less = [](double time_s) {
    return width_of(time_s < 1.0 ? 18.0 : time_s < 2.0 ? 20.0 : 19.2);
  };
  const auto moved_deg = [&](double dead_band_deg) {
    const Motion motion = driven({.dead_band_deg = dead_band_deg}, back_by_less, 4.0);
    return motion.angle_at(1.9) - motion.angle_at(3.9);
  };
  EXPECT_GT(moved_deg(0.0), 0.25);
  EXPECT_LT(moved_deg(1.3), 0.1);
}

TEST(ServoWorld, GivesWayToItsLoad) {
  const auto stands_at = [](double load_deg, double angle_deg) {
    return driven({.load_deg = load_deg}, step_to(angle_deg), 3.0).angle_at(2.9);
  };
  EXPECT_NEAR(stands_at(2.0, 90.0) - stands_at(0.0, 90.0), -2.0, 0.5);
  EXPECT_NEAR(stands_at(2.0, -90.0) - stands_at(0.0, -90.0), 2.0, 0.5);
}

/// Amplitude of the rate against the angle, with that period.
double ripple_dps(const ServoWorld& world, double period_deg) {
  ServoPlant plant(winch(), 2.0, 1, world);  // a soft loop: hardly a ripple by the pulses
  const Motion motion = drive(plant, sweep_at(60.0), 16.0);
  const double mean_dps = (motion.angle_at(15.99) - motion.angle_at(4.0)) / 11.99;
  double in_phase = 0.0, across = 0.0;
  const auto rates = motion.rates_between(4.0, 16.0);
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const double phase_rad = 2.0 * M_PI / period_deg * motion.angle_at(4.0 + step_s * static_cast<double>(i));
    in_phase += 2.0 * (rates[i] - mean_dps) * std::cos(phase_rad) / static_cast<double>(rates.size());
    across += 2.0 * (rates[i] - mean_dps) * std::sin(phase_rad) / static_cast<double>(rates.size());
  }
  return std::hypot(in_phase, across);
}

TEST(ServoWorld, RipplesWithItsGearsPeriod) {
  EXPECT_LT(ripple_dps({}, 24.0), 0.3);
  EXPECT_NEAR(ripple_dps({.ripple = 0.03, .ripple_period_deg = 24.0}, 24.0), 1.8, 0.5);
  EXPECT_NEAR(ripple_dps({.ripple = 0.03, .ripple_period_deg = 90.0}, 90.0), 1.8, 0.5);
  EXPECT_LT(ripple_dps({.ripple = 0.03, .ripple_period_deg = 90.0}, 24.0), 0.5);
}

TEST(ServoWorld, CannotPassItsCeiling) {
  const auto rates = driven({.top_speed_dps = 180.0}, sweep_at(200.0), 4.0).rates_between(2.0, 4.0);
  EXPECT_NEAR(quantile_of(rates, 1.0), 180.0, 1e-6);
  EXPECT_NEAR(median_of(rates), 180.0, 1.0);
}

TEST(ServoWorld, SlowsDownWithinSecondsOnAWeakSupply) {
  const Width far = [](double) { return width_of(1000.0); };
  const Motion strong = driven({}, far, 1.0);
  const Motion weak = driven(
      {.supply_sag = 0.6}, [](double time_s) { return width_of(400.0 * time_s); }, 2.6);
  const double top_dps = quantile_of(strong.rate_dps, 1.0);
  EXPECT_GT(quantile_of(weak.rates_between(0.0, 0.6), 1.0), 0.7 * top_dps);
  EXPECT_LT(weak.rate_at(2.5), 0.62 * top_dps);
}

}  // namespace
}  // namespace thermorig::simulation

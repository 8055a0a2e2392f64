// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include "calibrated_rig.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

/// A gyro at rest without a servo: a sample each 5 ms.
session::Session resting_session(double length_s, double (*rate_dps)(double time_s)) {
  session::Session session;
  for (int i = 0; i < static_cast<int>(length_s * 200); ++i) {
    TimedGyro sample;
    sample.stamp.time = HostTime(from_s(i * 0.005));
    sample.rate_dps = static_cast<float>(rate_dps(i * 0.005));
    session.gyro.push_back(sample);
  }
  return session;
}

double ripple(double time_s) {
  return 0.05 * std::sin(time_s * 100.0);
}

TEST(CalibrateBias, FindsTheBiasOfEachSimulatedGyroWithinItsUncertainty) {
  double squares = 0;
  const int seeds = 4;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const auto config = rig_with(seed);
    const auto recorded = record(config, plan_for(CalibrationKind::bias, config));
    const BiasResult result = measure_bias(recorded.session);
    const double off = (result.bias_dps.value - recorded.gyro.bias_dps) / result.bias_dps.uncertainty;
    EXPECT_LT(std::abs(off), 3.0) << seed;
    EXPECT_LT(result.bias_dps.uncertainty, 0.1) << seed;
    EXPECT_GT(result.rest_s, 50.0) << seed;
    EXPECT_NEAR(result.noise_dps, 0.07, 0.02) << seed;
    squares += off * off;
  }
  EXPECT_LT(squares / seeds, 2.0);
}

/// Two minutes of a bias that walks by 0.005 deg/s a square root of a second, below white noise.
session::Session walking_session(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  session::Session session;
  double bias_dps = 0.0;
  for (int i = 0; i < 120 * 200; ++i) {
    bias_dps += 0.005 * std::sqrt(0.005) * normal(random);
    TimedGyro sample;
    sample.stamp.time = HostTime(from_s(i * 0.005));
    sample.rate_dps = static_cast<float>(bias_dps + 0.1 * normal(random));
    session.gyro.push_back(sample);
  }
  return session;
}

TEST(CalibrateBias, StatesWhatTheNextMinuteMayDifferBy) {
  double squares = 0;
  const int seeds = 20;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    session::Session first_minute = walking_session(seed), second_minute = first_minute;
    const auto middle = static_cast<std::ptrdiff_t>(first_minute.gyro.size() / 2);
    first_minute.gyro.resize(static_cast<std::size_t>(middle));
    second_minute.gyro.erase(second_minute.gyro.begin(), second_minute.gyro.begin() + middle);
    const BiasResult first = measure_bias(first_minute), second = measure_bias(second_minute);
    const double off = (second.bias_dps.value - first.bias_dps.value) / first.bias_dps.uncertainty;
    EXPECT_LT(std::abs(off), 4.5) << seed;
    squares += off * off;
  }
  EXPECT_LT(squares / seeds, 2.0);
  EXPECT_GT(squares / seeds, 0.3);  // nor is it stated far too wide
}

TEST(CalibrateBias, LeavesOutWhatHandsDidToTheRig) {
  const auto touched = [](double time_s) {
    const double push = time_s > 20 && time_s < 31 ? 15.0 * std::sin(time_s) : 0.0;
    return 1.5 + ripple(time_s) + push;
  };
  const BiasResult result = measure_bias(resting_session(60.0, touched));
  EXPECT_NEAR(result.bias_dps.value, 1.5, 0.01);
  EXPECT_LT(result.rest_s, 50.0);
  EXPECT_GT(result.rest_s, 40.0);
}

TEST(CalibrateBias, CountsDriftAsUncertainty) {
  const BiasResult result =
      measure_bias(resting_session(60.0, [](double time_s) { return ripple(time_s) + time_s / 60.0; }));
  EXPECT_NEAR(result.drift_dps, 2.0 / 3.0, 0.05);
  EXPECT_GT(result.bias_dps.uncertainty, 0.4);
}

TEST(CalibrateBias, SaysWhyARestDoesNotTell) {
  const session::Session empty;
  EXPECT_THAT(refusal([&] { measure_bias(empty); }), HasSubstr("not at rest"));
  EXPECT_THAT(refusal([&] { measure_bias(resting_session(3.0, ripple)); }), HasSubstr("not at rest"));
  EXPECT_THAT(refusal([&] { measure_bias(resting_session(60.0, [](double) { return 0.25; })); }),
              HasSubstr("stuck"));
  EXPECT_THAT(refusal([&] { measure_bias(resting_session(60.0, [](double) { return std::nan(""); })); }),
              HasSubstr("not at rest"));
  session::Session zeroing = resting_session(60.0, ripple);
  zeroing.sync.gyro.zeroes_itself = true;
  EXPECT_THAT(refusal([&] { measure_bias(zeroing); }), HasSubstr("sets itself to zero"));
}

TEST(CalibrateBias, ReportsAGyroThatSetsItselfToZero) {
  auto config = rig_with(2);
  config.gyro_zeroes_itself = true;
  auto plan = plan_for(CalibrationKind::bias, config);
  plan.opening_rest_s = 20.0;
  EXPECT_THAT(refusal([&] { measure_bias(record(config, plan).session); }), HasSubstr("sets itself to zero"));
}

TEST(CalibrateBias, GoesIntoTheProfileWithItsDate) {
  RigProfile profile;
  apply(BiasResult{.bias_dps = {1.23456789, 0.0123456789}}, "2026-07-25T14:35:12Z", profile);
  EXPECT_DOUBLE_EQ(profile.gyro.bias_dps, 1.234568);
  EXPECT_DOUBLE_EQ(profile.gyro.bias_uncertainty_dps, 0.012346);
  EXPECT_EQ(profile.gyro.bias_measured_utc, "2026-07-25T14:35:12Z");
}

}  // namespace
}  // namespace thermorig::calibration

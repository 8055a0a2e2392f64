// SPDX-License-Identifier: MIT
// What each of the gyro's knobs does to its samples, against an honest gyro of the same seed.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "frame_statistics.h"
#include "simulation/gyro.h"

namespace thermorig::simulation {
namespace {

using Samples = std::vector<SimulatedGyroSample>;
using Rate = std::function<double(double time_s)>;

Samples samples_of(const GyroWorld& world, const Rate& rate_dps, double seconds, double angle_deg = 0.0) {
  Gyro gyro({}, GyroGrade::calibrated, 1, {}, world);
  Shaft shaft(angle_deg);
  Samples samples;
  for (std::int64_t step = 0; step < std::llround(seconds * 4000.0); ++step) {
    angle_deg += rate_dps(static_cast<double>(step) / 4000.0) / 4000.0;
    shaft.append(angle_deg);
    if (step % 40 != 39) continue;
    for (const auto& sample : gyro.follow(shaft)) samples.push_back(sample);
  }
  return samples;
}

Rate steady(double rate_dps) {
  return [rate_dps](double) { return rate_dps; };
}

/// Of one axis, those whose interval ends between two times.
std::vector<double> rates_between(const Samples& samples, double from_s, double to_s, std::size_t axis = 2) {
  std::vector<double> rates;
  for (const auto& sample : samples) {
    const double time_s = 1e-9 * static_cast<double>(sample.end.time_ns);
    if (time_s >= from_s && time_s < to_s) rates.push_back(sample.rate_dps[axis]);
  }
  return rates;
}

/// How much more than an honest gyro it shows of a steady rate.
double more_dps(const GyroWorld& world, double rate_dps, double from_s, double to_s, std::size_t axis = 2) {
  return mean_of(rates_between(samples_of(world, steady(rate_dps), to_s), from_s, to_s, axis)) -
         mean_of(rates_between(samples_of({}, steady(rate_dps), to_s), from_s, to_s, axis));
}

class GyroBandwidth : public testing::TestWithParam<double> {
 protected:
  double delay_s() const { return 1.0 / (std::sqrt(2.0) * M_PI * GetParam()); }  // of a Butterworth filter
};

TEST_P(GyroBandwidth, DelaysAStepByItsGroupDelay) {
  const Rate step = [](double time_s) { return time_s < 1.0 ? 0.0 : 100.0; };
  const Samples honest = samples_of({}, step, 2.0);
  const Samples filtered = samples_of({.bandwidth_hz = GetParam()}, step, 2.0);
  ASSERT_EQ(honest.size(), filtered.size());
  double missing_deg = 0.0;
  for (std::size_t i = 0; i < honest.size(); ++i)
    missing_deg += (honest[i].rate_dps[2] - filtered[i].rate_dps[2]) / 200.0;
  EXPECT_NEAR(missing_deg / 100.0, delay_s(), 0.0004);
}

TEST_P(GyroBandwidth, IsInTheTruthOfItsExposure) {
  const Rate swing = [](double time_s) { return 100.0 * std::sin(2.0 * M_PI * 0.5 * time_s); };
  const Samples honest = samples_of({}, swing, 4.0);
  const Samples filtered = samples_of({.bandwidth_hz = GetParam()}, swing, 4.0);
  double honest_off_dps = 0.0, off_dps = 0.0;
  for (std::size_t i = 200; i < filtered.size(); ++i) {
    EXPECT_NEAR(1e-9 * static_cast<double>(honest[i].end.time_ns - filtered[i].end.time_ns), delay_s(), 1e-4);
    EXPECT_EQ(filtered[i].ready_ns, honest[i].ready_ns);
    off_dps += std::abs(filtered[i].rate_dps[2] - mean_rate_dps(filtered[i].begin, filtered[i].end));
    honest_off_dps += std::abs(honest[i].rate_dps[2] - mean_rate_dps(honest[i].begin, honest[i].end));
  }
  const auto count = static_cast<double>(filtered.size() - 200);
  EXPECT_NEAR(off_dps / count, honest_off_dps / count, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Hz, GyroBandwidth, testing::Values(5.0, 20.0, 98.0, 188.0));

TEST(GyroWorld, HasLessNoiseBehindALowPass) {
  const auto noise_dps = [](double bandwidth_hz) {
    return deviation_of(
        rates_between(samples_of({.bandwidth_hz = bandwidth_hz}, steady(0.0), 20.0), 1.0, 20.0));
  };
  EXPECT_NEAR(noise_dps(256.0), 0.053, 0.01);
  EXPECT_LT(noise_dps(20.0), 0.7 * noise_dps(256.0));
}

TEST(GyroWorld, ShowsTheRateOnItsOtherAxes) {
  EXPECT_NEAR(more_dps({.cross_axis = 0.02}, 100.0, 0.0, 2.0, 0), 2.0, 0.02);
  EXPECT_NEAR(more_dps({.cross_axis = 0.02}, 100.0, 0.0, 2.0, 1), 2.0, 0.02);
  EXPECT_NEAR(more_dps({.cross_axis = 0.02}, 100.0, 0.0, 2.0, 2), 0.0, 1e-9);
}

TEST(GyroWorld, FeelsGravityThatTurnsWithTheShaft) {
  const auto rest_at = [](double angle_deg, double sensitivity) {
    return mean_of(rates_between(samples_of({.g_sensitivity_dps = sensitivity}, steady(0.0), 20.0, angle_deg),
                                 0.0, 20.0));
  };
  EXPECT_EQ(rest_at(0.0, 0.0), rest_at(180.0, 0.0));
  EXPECT_NEAR(rest_at(0.0, 0.1) - rest_at(180.0, 0.1), 2.0 * 0.1 * 0.087, 0.006);
}

TEST(GyroWorld, WarmsUpWithItsTimeConstant) {
  const GyroWorld world{.self_heating_k = 10.0, .self_heating_s = 30.0};
  const Samples warming = samples_of(world, steady(0.0), 31.0);
  const double warm_c = samples_of({}, steady(0.0), 1.0).front().temp_c;
  EXPECT_NEAR(warming.front().temp_c - warm_c, -10.0, 0.01);
  EXPECT_NEAR(warming[6000].temp_c - warm_c, -10.0 * std::exp(-1.0), 0.01);
  const GyroWorld slower{.self_heating_k = 10.0, .self_heating_s = 600.0};
  EXPECT_LT(samples_of(slower, steady(0.0), 31.0).back().temp_c - warm_c, -9.4);
}

TEST(GyroWorld, HasABiasThatFollowsItsTemperature) {
  const GyroWorld world{.self_heating_k = 10.0, .self_heating_s = 30.0, .bias_per_k_dps = 0.3};
  EXPECT_NEAR(more_dps(world, 0.0, 0.0, 1.0), -3.0 * std::exp(-0.5 / 30.0), 0.02);
  EXPECT_NEAR(more_dps(world, 0.0, 89.5, 90.5), -3.0 * std::exp(-3.0), 0.02);
}

TEST(GyroWorld, HasAScaleThatFollowsItsTemperature) {
  const GyroWorld world{.self_heating_k = 10.0, .self_heating_s = 30.0, .scale_per_k = 0.0003};
  EXPECT_NEAR(more_dps(world, 200.0, 0.0, 1.0), -0.59, 0.02);
  EXPECT_NEAR(more_dps(world, 200.0, 89.5, 90.5), -0.03, 0.02);
}

TEST(GyroWorld, HasAnotherScaleThanWhenItWasCalibrated) {
  EXPECT_NEAR(more_dps({.scale_change = 0.01}, 200.0, 0.0, 2.0), 2.0, 0.02);
  EXPECT_NEAR(more_dps({.scale_change = -0.01}, 200.0, 0.0, 2.0), -2.0, 0.02);
}

TEST(GyroWorld, VibratesWhileTheShaftTurns) {
  const auto noise_dps = [](double rate_dps) {
    return deviation_of(rates_between(samples_of({.vibration_dps = 5.0}, steady(rate_dps), 10.0), 0.0, 10.0));
  };
  EXPECT_LT(noise_dps(0.0), 0.1);
  EXPECT_NEAR(noise_dps(50.0), 5.0, 0.4);
}

TEST(GyroWorld, ZeroesItselfBelowItsThreshold) {
  const auto zeros_dps = [](double zero_below_dps, double rate_dps) {
    int zeros = 0;
    for (const double rate :
         rates_between(samples_of({.zero_below_dps = zero_below_dps}, steady(rate_dps), 4.0), 2.0, 4.0))
      zeros += rate == 0.0 ? 1 : 0;
    return zeros;
  };
  EXPECT_LT(zeros_dps(0.0, 0.0), 300);  // counts that happen to be 0
  EXPECT_EQ(zeros_dps(1.0, 0.0), 400);
  EXPECT_EQ(zeros_dps(1.0, 0.8), 400);
  EXPECT_EQ(zeros_dps(0.5, 0.8), 0);
}

}  // namespace
}  // namespace thermorig::simulation

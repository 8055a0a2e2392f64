// SPDX-License-Identifier: MIT
// Speeds that a servo was commanded and did not reach: told by the gyro alone, before anything is fitted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "fit/shaft/reached_speeds.h"
#include "labels/scripted_rig.h"

namespace thermorig::fit {

using namespace labels;

namespace {

constexpr double leg_s = 8.0;

/// Legs one after the other, and what the gyro made of them.
struct Sweep {
  std::vector<double> rates_dps;
  std::function<double(double)> shaft_dps = [](double commanded) { return commanded; };
  std::function<double(double)> bias_dps = [](double) { return 0.0; };
  double bias_uncertainty_dps = 0.05;
  double gyro_period_s = 0.005;  // a sample is the mean over it
  ServoKind kind = ServoKind::positional;

  std::vector<Interval> legs() const {
    std::vector<Interval> legs;
    for (std::size_t i = 0; i < rates_dps.size(); ++i) {
      const double begin_s = leg_s * static_cast<double>(i);
      legs.push_back({begin_s, begin_s + leg_s, rates_dps[i], static_cast<std::uint16_t>(i + 1)});
    }
    return legs;
  }

  double shaft_at_dps(double t) const {
    const auto leg = static_cast<std::size_t>(std::max(t, 0.0) / leg_s);
    return shaft_dps(rates_dps[std::min(leg, rates_dps.size() - 1)]);
  }

  std::vector<ReachedSpeed> reached() const {
    std::vector<TimedGyro> gyro;
    for (double t = 0.0; t < leg_s * static_cast<double>(rates_dps.size()) + 1.0; t += gyro_period_s) {
      TimedGyro sample;
      sample.stamp.time = at_s(t);
      const double mean_dps = (shaft_at_dps(t - gyro_period_s / 4) + shaft_at_dps(t + gyro_period_s / 4)) / 2;
      sample.rate_dps = static_cast<float>(mean_dps + bias_dps(t));
      gyro.push_back(sample);
    }
    GyroErrors errors;
    errors.scale = {1.0, 0.001};
    const GyroIntegral integral(gyro, errors, at_s(0.0));
    return reached_speeds(legs(), integral, bias_uncertainty_dps, kind);
  }

  /// Those that contradict, ascending.
  std::vector<double> named() const {
    std::vector<double> named;
    for (const ReachedSpeed& speed : reached())
      if (speed.contradicts) named.push_back(speed.rate_dps);
    return named;
  }
};

const std::vector<double> both_ways{20, -20, 60, -60, 120, -120, 200, -200};

double at_most_181(double commanded) {
  return std::copysign(std::min(std::abs(commanded), 181.0), commanded);
}

TEST(ReachedSpeeds, ASpeedThatIsNotReachedIsNamedWithTheOneThatWas) {
  const Sweep sweep{.rates_dps = both_ways, .shaft_dps = at_most_181};
  EXPECT_EQ(sweep.named(), (std::vector<double>{-200.0, 200.0}));
  EXPECT_NEAR(sweep.reached().front().reached_dps, -181.0, 0.2);
  EXPECT_NEAR(sweep.reached().back().reached_dps, 181.0, 0.2);
}

TEST(ReachedSpeeds, OfAGyroThatSendsOnceASecondAreThoseBetweenItsReversals) {
  Sweep sweep{both_ways};
  sweep.gyro_period_s = 1.0;
  for (const ReachedSpeed& speed : sweep.reached()) EXPECT_NEAR(speed.reached_dps, speed.rate_dps, 0.01);
}

TEST(ReachedSpeeds, AScaleThatAllShareIsNoContradiction) {
  const Sweep winch{.rates_dps = both_ways, .shaft_dps = [](double commanded) { return 1.03 * commanded; }};
  EXPECT_TRUE(winch.named().empty());
}

TEST(ReachedSpeeds, ABiasThatMovedIsNoneWhereBothDirectionsTell) {
  const Sweep drifting{.rates_dps = both_ways, .bias_dps = [](double) { return 4.0; }};
  EXPECT_TRUE(drifting.named().empty());
}

TEST(ReachedSpeeds, OneWayAloneIsAsCertainAsTheBias) {
  Sweep sweep{.rates_dps = {20, 60, 120, 200}, .bias_dps = [](double t) { return t > 24.0 ? 9.0 : 0.0; }};
  EXPECT_EQ(sweep.named(), std::vector<double>{200.0});
  sweep.bias_uncertainty_dps = 20.0;
  EXPECT_TRUE(sweep.named().empty());
}

TEST(ReachedSpeeds, ASpeedOfAContinuousServoMayStrayFurtherFromAStraightLine) {
  Sweep sweep{.rates_dps = both_ways, .shaft_dps = [](double commanded) {
                return std::abs(commanded) > 150.0 ? 0.95 * commanded : commanded;
              }};
  EXPECT_EQ(sweep.named(), (std::vector<double>{-200.0, 200.0}));
  sweep.kind = ServoKind::continuous;
  EXPECT_TRUE(sweep.named().empty());
}

/// Friction takes half a degree a second: of the slowest of three speeds that is much, and says little of the
/// fastest.
TEST(ReachedSpeeds, OfThreeTheSlowestDoesNotSayThatTheFastestStrays) {
  Sweep sweep{.rates_dps = {30, -30, 90, -90, 150, -150}, .shaft_dps = [](double commanded) {
                return std::abs(commanded) < 50.0 ? 0.984 * commanded : 1.004 * commanded;
              }};
  EXPECT_TRUE(sweep.named().empty());
  sweep.shaft_dps = [](double commanded) {
    return std::copysign(std::min(std::abs(commanded), 135.0), commanded);
  };
  EXPECT_EQ(sweep.named(), (std::vector<double>{-150.0, 150.0}));
}

TEST(ReachedSpeeds, AreLeftOutUntilTheShaftHasCaughtUp) {
  const Sweep sweep{.rates_dps = {60, 200, 120}, .shaft_dps = at_most_181};
  auto reached = sweep.reached();
  reached.back().contradicts = true;
  const auto strayed = strayed_intervals(sweep.legs(), reached);
  ASSERT_EQ(strayed.size(), 1U);
  const double lag_s = 8.0 * (200.0 - 181.0) / 181.0;  // for the angle that it is behind
  EXPECT_NEAR(strayed[0].begin_s, 7.0, 1e-9);
  EXPECT_NEAR(strayed[0].end_s, 16.0 + 1.0 + lag_s, 0.01);
  EXPECT_TRUE(is_within(strayed, 12.0));
  EXPECT_FALSE(is_within(strayed, 6.0));
  EXPECT_FALSE(is_within(strayed, 18.0));
}

TEST(ReachedSpeeds, FramesAtOneThatContradictsAreNotValid) {
  ScriptedRig rig;  // commanded and by the gyro 100 deg/s
  rig.config.response.fitted = true;
  rig.config.response.residual_dps = 0.1;
  const auto is_valid = [&] {
    const auto samples = rig.run(2.0);
    return !has(samples.back(), Reason::gyro_disagrees) && samples[10].valid;
  };
  EXPECT_TRUE(is_valid());
  rig.config.response.speeds = {{.rate_dps = 100.0, .reached_dps = 91.0, .contradicts = true}};
  EXPECT_FALSE(is_valid());
}

}  // namespace
}  // namespace thermorig::fit

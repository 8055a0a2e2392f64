// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hand_made.h"
#include "support/at_s.h"
#include "thermorig/core/statistics.h"

namespace thermorig::estimators {
namespace {

GyroProfile unknown_bias() {
  GyroProfile gyro = exact_gyro();
  gyro.bias_uncertainty_dps = 5.0;
  return gyro;
}

std::vector<RateEstimate> kalman(const HandMadeRig& rig, const GyroProfile& gyro = unknown_bias()) {
  return estimates_of("gyro-kalman", gyro, measurements_of(rig));
}

/// The frame whose exposure ends then.
const RateEstimate& at(double end_s, const std::vector<RateEstimate>& estimates) {
  return estimates.at(static_cast<std::size_t>(std::lround((end_s - 0.25) / 0.125)));
}

float bias_dps(const RateEstimate& estimate) {
  return estimate.values[0];
}
float bias_sigma_dps(const RateEstimate& estimate) {
  return estimate.values[1];
}

TEST(GyroKalman, BeforeARestSaysHowLittleIsKnownOfTheBias) {
  const auto estimates = kalman(rest_and_speed(0.0, 50.0, 1.5));
  EXPECT_EQ(estimates.back().state, EstimateState::starting);
  EXPECT_EQ(estimates.back().reason, EstimateReason::no_rest);
  EXPECT_NEAR(estimates.back().rate_dps, 51.5F, 0.1F);
  EXPECT_NEAR(estimates.back().rate_sigma_dps, 5.0F, 0.01F);
}

TEST(GyroKalman, LearnsTheBiasAtARest) {
  const auto estimates = kalman(rest_and_speed(4.0, 50.0, 1.5));
  const RateEstimate& last = estimates.back();
  EXPECT_EQ(last.state, EstimateState::good);
  EXPECT_EQ(last.reason, EstimateReason::none);
  EXPECT_NEAR(bias_dps(last), 1.5F, 3.0F * bias_sigma_dps(last));
  EXPECT_LT(bias_sigma_dps(last), 0.02F);
  EXPECT_NEAR(last.rate_dps, 50.0F, 3.0F * last.rate_sigma_dps);
  EXPECT_LT(last.rate_sigma_dps, 0.03F);
}

TEST(GyroKalman, CorrectsTheAngleForTheBiasThatARestShows) {
  HandMadeRig rig{.duration_s = 12.0};
  rig.is_told_to_move = [](double time_s) { return time_s < 6.0; };
  rig.gyro_dps = [](double time_s) { return time_s < 6.0 ? 51.5F : 1.5F; };
  const auto estimates = kalman(rig);
  EXPECT_NEAR(at(6.0, estimates).angle_deg, 51.5 * 6.0, 0.5);
  EXPECT_GT(at(6.0, estimates).angle_sigma_deg, 25.0F);
  EXPECT_NEAR(estimates.back().angle_deg, 50.0 * 6.0, 3.0 * double{estimates.back().angle_sigma_deg});
  EXPECT_LT(estimates.back().angle_sigma_deg, 0.3F);
}

TEST(GyroKalman, FollowsABiasThatWandersBetterThanTheBiasOfTheOpeningRest) {
  HandMadeRig rig{.duration_s = 300.0};
  const auto moves = [](double time_s) { return std::fmod(time_s, 10.0) >= 4.0; };
  rig.is_told_to_move = moves;
  rig.gyro_dps = [=](double time_s) {
    return static_cast<float>(1.5 + 0.0003 * time_s + (moves(time_s) ? 50.0 : 0.0));
  };
  const auto measurements = measurements_of(rig);
  const double true_deg = 50.0 * 180.0;
  const double kalman_deg = kalman(rig).back().angle_deg - true_deg;
  const double rest_deg = estimates_of("gyro-rest", exact_gyro(), measurements).back().angle_deg - true_deg;
  EXPECT_GT(std::abs(rest_deg), 10.0);
  EXPECT_LT(std::abs(kalman_deg), 1.0);
}

TEST(GyroKalman, FollowsARampOfTheServoWithoutALag) {
  HandMadeRig rig = rest_and_speed(4.0, 0.0, 1.5);
  rig.exposure_s = 0.02;
  rig.gyro_dps = [](double time_s) {
    return static_cast<float>(1.5 + std::clamp(2000.0 * (time_s - 4.2), 0.0, 200.0));
  };
  const auto estimates = kalman(rig);
  EXPECT_NEAR(at(4.25, estimates).rate_dps, 80.0F,
              1.0F);  // of 60 to 100: a lag of one sample would be 10 deg/s
  EXPECT_NEAR(at(4.375, estimates).rate_dps, 200.0F, 0.3F);
  EXPECT_NEAR(at(4.375, estimates).angle_deg, 10.0 + 15.0, 0.05);
}

TEST(GyroKalman, SmoothsASteadySpeed) {
  HandMadeRig rig = rest_and_speed(4.0, 50.0, 1.5);
  rig.duration_s = 60.0;
  rig.exposure_s = 0.005;  // so short that a mean over it smooths nothing
  rig.noise_dps = 0.1;
  RunningStatistics raw, smoothed;
  const auto run = measurements_of(rig);
  const auto estimates = estimates_of("gyro-kalman", unknown_bias(), run);
  for (std::size_t i = 40; i < run.size(); ++i) {
    raw.add(double{run[i].sample.rate_gyro_dps});
    smoothed.add(double{estimates[i].rate_dps});
  }
  EXPECT_NEAR(std::sqrt(raw.variance()), 0.1, 0.02);
  EXPECT_LT(std::sqrt(smoothed.variance()), 0.04);
}

TEST(GyroKalman, TakesTheScaleOfTheProfileAndItsUncertainty) {
  GyroProfile gyro = unknown_bias();
  gyro.scale = 1.25;
  gyro.scale_uncertainty = 0.025;
  const RateEstimate last = kalman(rest_and_speed(4.0, 50.0, 1.5), gyro).back();
  EXPECT_NEAR(last.rate_dps, 40.0F, 0.03F);
  EXPECT_NEAR(last.rate_sigma_dps, 0.025 * 40.0 / 1.25, 0.01);
  EXPECT_NEAR(last.angle_deg, 240.0, 0.2);
  EXPECT_NEAR(last.angle_sigma_deg, 0.025 * 240.0 / 1.25, 0.02);
}

TEST(GyroKalman, LearnsFromRestsThatTheGyroShowsWhereNoServoSpeaks) {
  HandMadeRig rig = rest_and_speed(4.0, 50.0, 1.5);
  rig.has_servo = false;
  const RateEstimate last = kalman(rig).back();
  EXPECT_EQ(last.state, EstimateState::good);
  EXPECT_NEAR(bias_dps(last), 1.5F, 0.02F);  // the 50 deg/s are as steady, and no bias
}

TEST(GyroKalman, DoesNotTakeASteadySpeedThatTheServoIsToldForABias) {
  const auto estimates = kalman(rest_and_speed(0.0, 3.0, 1.5));  // within what the bias may be
  EXPECT_EQ(estimates.back().state, EstimateState::starting);
  EXPECT_NEAR(estimates.back().rate_dps, 4.5F, 0.1F);
}

TEST(GyroKalman, DoesNotTakeAHandThatTurnsTheRigForABias) {
  HandMadeRig rig{.duration_s = 16.0};
  rig.gyro_dps = [](double time_s) {
    const double turned = time_s < 4.0 || time_s > 14.0 ? 0.0 : (time_s - 4.0) / 10.0;
    return static_cast<float>(1.5 + 36.0 * (1.0 - std::cos(2.0 * std::numbers::pi * turned)));
  };
  const RateEstimate last = kalman(rig).back();
  EXPECT_NEAR(bias_dps(last), 1.5F, 0.02F);
  EXPECT_NEAR(last.angle_deg, 360.0, 0.3);
}

TEST(GyroKalman, OfAGyroThatSetsItselfToZeroStandsStillWhileItDoesAndLearnsNothing) {
  HandMadeRig rig;
  rig.noise_dps = 0.0;
  rig.is_told_to_move = [](double time_s) { return time_s >= 5.0; };
  rig.gyro_dps = [](double time_s) { return time_s < 5.0 ? 0.0F : 51.5F; };
  const auto estimates = kalman(rig);
  EXPECT_NEAR(at(5.0, estimates).rate_dps, 0.0F, 1e-3F);
  EXPECT_NEAR(at(5.0, estimates).angle_deg, 0.0, 1e-3);
  EXPECT_LT(at(5.0, estimates).angle_sigma_deg, 0.1F);
  EXPECT_GE(bias_sigma_dps(estimates.back()), 5.0F);
  EXPECT_NEAR(bias_dps(estimates.back()), 0.0F, 1e-3F);
}

TEST(GyroKalman, IsLessSureOfFramesThatLackSamples) {
  HandMadeRig rig = rest_and_speed(4.0, 50.0, 1.5);
  rig.has_gyro = [](double time_s) { return time_s < 6.0 || time_s > 6.1; };
  const auto estimates = kalman(rig);
  EXPECT_LT(at(5.75, estimates).rate_sigma_dps, 0.03F);
  EXPECT_NEAR(at(6.125, estimates).rate_dps, 50.0F, 0.1F);
  EXPECT_GT(at(6.125, estimates).rate_sigma_dps, 1.0F);  // it may have stopped and gone on
  EXPECT_LT(at(6.5, estimates).rate_sigma_dps, 0.03F);
  EXPECT_GT(at(6.5, estimates).angle_sigma_deg, at(5.75, estimates).angle_sigma_deg + 0.5F);
}

TEST(GyroKalman, LeavesOutSamplesAtTheEndOfTheGyrosRange) {
  auto run = measurements_of(rest_and_speed(4.0, 50.0, 1.5));
  for (TimedGyro& sample : run[40].gyro) {
    sample.reading.saturated = true;
    sample.rate_dps = 250.0F;
  }
  const auto estimates = estimates_of("gyro-kalman", unknown_bias(), run);
  EXPECT_NEAR(estimates[41].rate_dps, 50.0F, 0.1F);
  EXPECT_GT(estimates[41].rate_sigma_dps, 1.0F);
}

TEST(GyroKalman, OfAWindowIsTheMeanOfItsFrames) {
  const auto run = measurements_of(rest_and_speed(4.0, 50.0, 1.5));
  const auto single = estimates_of("gyro-kalman", unknown_bias(), run);
  Bank bank = bank_of("gyro-kalman", unknown_bias(), untrained_model({.frames = 3}));
  const auto window = estimates_of(bank, run);
  EXPECT_EQ(window[1].reason, EstimateReason::no_gyro);
  for (std::size_t i = 2; i < run.size(); ++i)
    EXPECT_NEAR(window[i].rate_dps,
                (single[i].rate_dps + single[i - 1].rate_dps + single[i - 2].rate_dps) / 3.0F, 1e-4F);
}

}  // namespace
}  // namespace thermorig::estimators

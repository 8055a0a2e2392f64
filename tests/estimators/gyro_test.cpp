// SPDX-License-Identifier: MIT
// The gyro as it is, and less the bias of the opening rest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hand_made.h"
#include "support/at_s.h"

namespace thermorig::estimators {
namespace {

HandMadeRig steady(float rate_dps) {
  return {.gyro_dps = [rate_dps](double) { return rate_dps; }, .noise_dps = 0.0};
}

TEST(Gyro, SaysTheMeanOverTheExposureAndTheAngleSinceItsFirstSample) {
  const auto run = measurements_of(steady(40.0F));
  const auto estimates = estimates_of("gyro", exact_gyro(), run);
  for (std::size_t i = 0; i < run.size(); ++i) {
    EXPECT_FLOAT_EQ(estimates[i].rate_dps, 40.0F);
    const double elapsed_s = to_s(run[i].frame.exposure_end - at_s(0.0025));
    EXPECT_NEAR(estimates[i].angle_deg, 40.0 * elapsed_s, 1e-9);
    EXPECT_EQ(estimates[i].rate_sigma_dps, 0.0F);  // of a gyro without errors
    EXPECT_EQ(estimates[i].angle_sigma_deg, 0.0F);
    EXPECT_EQ(estimates[i].state, EstimateState::good);
  }
}

TEST(Gyro, StatesAsSigmaWhatTheProfileSaysOfBiasAndScale) {
  GyroProfile gyro = exact_gyro();
  gyro.bias_dps = 3.0;
  gyro.bias_uncertainty_dps = 4.0;
  gyro.scale = 1.03;
  gyro.scale_uncertainty = 0.04;
  const auto run = measurements_of(steady(40.0F));
  const RateEstimate last = estimates_of("gyro", gyro, run).back();
  EXPECT_NEAR(last.rate_sigma_dps, std::hypot(5.0, 0.05 * 40.0), 1e-5);
  const double elapsed_s = to_s(run.back().frame.exposure_end - at_s(0.0025));
  EXPECT_NEAR(last.angle_sigma_deg, std::hypot(5.0 * elapsed_s, 0.05 * 40.0 * elapsed_s), 1e-4);
}

TEST(Gyro, IsLessSureWhereTheSpeedChangesAndItsTimeIsNotKnown) {
  GyroProfile gyro = exact_gyro();
  gyro.link.latency_uncertainty_s = 0.01;
  HandMadeRig rig = steady(0.0F);
  rig.gyro_dps = [](double time_s) { return time_s < 5.0 ? 0.0F : 100.0F; };
  const auto estimates = estimates_of("gyro", gyro, measurements_of(rig));
  const auto at = [&](double end_s) { return estimates[static_cast<std::size_t>((end_s - 0.25) / 0.125)]; };
  EXPECT_EQ(at(4.875).rate_sigma_dps, 0.0F);
  EXPECT_NEAR(at(5.125).rate_sigma_dps, 100.0 * std::hypot(0.01, 0.0025) / 0.25, 0.01);
  EXPECT_EQ(at(5.5).rate_sigma_dps, 0.0F);
  EXPECT_NEAR(at(5.5).angle_sigma_deg, 1.0, 1e-4);  // it turned on for 10 ms more, or less
}

TEST(Gyro, BridgesLostSamplesAndSaysHowMuchMayBeHiddenThere) {
  HandMadeRig rig = steady(40.0F);
  rig.has_gyro = [](double time_s) { return time_s < 5.0 || time_s > 5.1; };
  const RateEstimate last = estimates_of("gyro", exact_gyro(), measurements_of(rig)).back();
  EXPECT_NEAR(last.angle_deg, 40.0 * (10.0 - 0.0025), 1e-9);
  EXPECT_NEAR(last.angle_sigma_deg, 2000.0 * 0.1 * 0.1 / 16.0, 0.01);
}

TEST(Gyro, CountsItsAngleOnAfterItsClockBeganAnew) {
  HandMadeRig rig = steady(40.0F);
  rig.is_told_to_move = [](double) { return true; };
  auto run = measurements_of(rig);
  const std::size_t half = run.size() / 2;
  for (std::size_t i = half; i < run.size(); ++i) {
    run[i].frame.exposure_begin -= std::chrono::hours(1);
    run[i].frame.exposure_end -= std::chrono::hours(1);
    for (TimedGyro& sample : run[i].gyro) sample.stamp.time -= std::chrono::hours(1);
  }
  for (const std::string name : {"gyro", "gyro-kalman"}) {
    const auto estimates = estimates_of(name, exact_gyro(), run);
    for (std::size_t i = half + 1; i < run.size(); ++i)
      EXPECT_NEAR(estimates[i].angle_deg - estimates[i - 1].angle_deg, 40.0 * 0.125, 1e-6) << name;
  }
}

TEST(Gyro, OfAWindowIsTheMeanOfItsFrames) {
  HandMadeRig rig = steady(0.0F);
  rig.gyro_dps = [](double time_s) { return static_cast<float>(100.0 * time_s); };
  const auto run = measurements_of(rig);
  Bank bank = bank_of("gyro", exact_gyro(), untrained_model({.frames = 3}));
  const auto estimates = estimates_of(bank, run);
  EXPECT_EQ(estimates[1].reason, EstimateReason::no_gyro);
  for (std::size_t i = 2; i < run.size(); ++i) {
    const double middle_s = 0.125 + 0.125 * static_cast<double>(i - 1);
    EXPECT_NEAR(estimates[i].rate_dps, 100.0 * middle_s, 1e-3);
  }
}

TEST(Gyro, WithoutASampleInTheExposureSaysSo) {
  HandMadeRig rig = steady(40.0F);
  rig.has_gyro = [](double time_s) { return time_s < 5.0; };
  const RateEstimate last = estimates_of("gyro", exact_gyro(), measurements_of(rig)).back();
  EXPECT_EQ(last.state, EstimateState::absent);
  EXPECT_EQ(last.reason, EstimateReason::no_gyro);
  EXPECT_TRUE(std::isnan(last.rate_dps) && std::isnan(last.rate_sigma_dps));
  EXPECT_GT(last.angle_sigma_deg, 100.0F);
}

TEST(GyroRest, RemovesTheBiasOfTheOpeningRest) {
  const auto run = measurements_of(rest_and_speed(4.0, 50.0, 1.5));
  const auto estimates = estimates_of("gyro-rest", exact_gyro(), run);
  EXPECT_EQ(estimates.front().state, EstimateState::absent);
  EXPECT_EQ(estimates.front().reason, EstimateReason::no_rest);
  EXPECT_EQ(estimates[25].state, EstimateState::starting);  // at 3.4 s: it still learns
  const RateEstimate last = estimates.back();
  EXPECT_EQ(last.state, EstimateState::good);
  EXPECT_NEAR(last.values[0], 1.5F, 0.01F);
  EXPECT_NEAR(last.rate_dps, 50.0F, 0.03F);
  EXPECT_NEAR(last.angle_deg, 50.0 * 6.0, 0.1);
}

TEST(GyroRest, LearnsNothingOnceTheRigHasMoved) {
  HandMadeRig rig;
  rig.is_told_to_move = [](double time_s) { return time_s >= 4.0 && time_s < 5.0; };
  rig.gyro_dps = [](double time_s) { return time_s < 4.0 ? 1.5F : time_s < 5.0 ? 50.0F : 2.0F; };
  const RateEstimate last = estimates_of("gyro-rest", exact_gyro(), measurements_of(rig)).back();
  EXPECT_NEAR(last.values[0], 1.5F, 0.01F);
  EXPECT_NEAR(last.rate_dps, 0.5F, 0.03F);
}

TEST(GyroRest, WaitsForARestThatIsLongEnough) {
  HandMadeRig rig;
  rig.is_told_to_move = [](double time_s) { return time_s >= 1.0 && time_s < 3.0; };
  rig.gyro_dps = [](double time_s) { return time_s >= 1.0 && time_s < 3.0 ? 50.0F : 1.5F; };
  const auto estimates = estimates_of("gyro-rest", exact_gyro(), measurements_of(rig));
  EXPECT_EQ(estimates[20].reason, EstimateReason::no_rest);  // at 2.75 s
  EXPECT_NEAR(estimates.back().values[0], 1.5F, 0.01F);
}

TEST(GyroRest, DoesNotTakeAHandThatTurnsTheRigForABias) {
  HandMadeRig rig{.duration_s = 16.0};
  rig.gyro_dps = [](double time_s) {
    const double turned = time_s < 4.0 || time_s > 14.0 ? 0.0 : (time_s - 4.0) / 10.0;
    return static_cast<float>(1.5 + 36.0 * (1.0 - std::cos(2.0 * std::numbers::pi * turned)));
  };
  const RateEstimate last = estimates_of("gyro-rest", exact_gyro(), measurements_of(rig)).back();
  EXPECT_NEAR(last.values[0], 1.5F, 0.01F);
  EXPECT_NEAR(last.angle_deg, 360.0, 0.3);
}

TEST(GyroRest, SaysNothingWithoutAServoOrWithAGyroThatHidesItsBias) {
  HandMadeRig alone;
  alone.has_servo = false;
  HandMadeRig zeroed;
  zeroed.noise_dps = 0.0;
  for (const HandMadeRig& rig : {alone, zeroed}) {
    const RateEstimate last = estimates_of("gyro-rest", exact_gyro(), measurements_of(rig)).back();
    EXPECT_EQ(last.state, EstimateState::absent);
    EXPECT_EQ(last.reason, EstimateReason::no_rest);
  }
}

}  // namespace
}  // namespace thermorig::estimators

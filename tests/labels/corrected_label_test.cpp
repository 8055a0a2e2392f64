// SPDX-License-Identifier: MIT
// The commanded speed, corrected by what the session measured of its servo, and what either of the two is
// worth.
#include <gtest/gtest.h>

#include <cmath>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

/// The servo makes 98 % of what it is told, of which the gyro sees 100, and 1 deg/s less at 100 deg/s.
ServoResponse slow_response() {
  ServoResponse response;
  response.fitted = true;
  response.delay_uncertainty_s = 0.0;
  response.scale = {0.98, 0.001};
  response.gyro_ratio = {1.0, 0.0};
  response.residual_dps = 0.2;
  response.speeds = {{.rate_dps = -100.0, .residual_dps = -5.0, .spread_dps = 0.1},
                     {.rate_dps = 100.0, .residual_dps = -1.0, .spread_dps = 0.1}};
  return response;
}

LabelledSample sample_of(const ScriptedRig& rig) {
  return rig.run(2.0).at(9);
}

TEST(CorrectedLabel, HasTheScaleOfTheServoAndWhatTheGyroSawBeyondIt) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  const LabelledSample sample = sample_of(rig);
  EXPECT_NEAR(sample.rate_commanded_dps, 100.0, 0.05);
  EXPECT_NEAR(sample.rate_corrected_dps, 0.98 * (100.0 - 1.0), 0.1);
  for (const std::size_t half : {0U, 1U})
    EXPECT_NEAR(sample.rate_corrected_half_dps[half], 0.9702F * sample.rate_commanded_half_dps[half], 0.1);
}

TEST(CorrectedLabel, LooksAtTheSpeedInTheSameDirection) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  rig.rate_dps = [](double) { return -100.0; };
  rig.angle_deg = [](double t) { return 900.0 - 100.0 * t; };
  EXPECT_NEAR(sample_of(rig).rate_corrected_dps, 0.98 * -105.0, 0.1);
}

TEST(CorrectedLabel, OfASpeedThatNoLegHadIsOnTheScaleOfTheServo) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  rig.rate_dps = [](double) { return 60.0; };
  EXPECT_NEAR(sample_of(rig).rate_corrected_dps, 0.98 * 60.0, 0.05);
}

TEST(CorrectedLabel, IsTheCommandedOneWhereNothingWasFitted) {
  const LabelledSample sample = sample_of(ScriptedRig());
  EXPECT_EQ(sample.rate_corrected_dps, sample.rate_commanded_dps);
  EXPECT_EQ(sample.rate_corrected_half_dps, sample.rate_commanded_half_dps);
  EXPECT_FLOAT_EQ(sample.rate_corrected_uncertainty_dps, sample.rate_commanded_uncertainty_dps);
  EXPECT_GT(sample.rate_commanded_uncertainty_dps, 100.0F * 0.015F);  // what servos are known for
  EXPECT_LT(sample.rate_commanded_uncertainty_dps, 100.0F * 0.04F);
}

TEST(CorrectedLabel, IsCloserToTheShaftThanTheCommandedOneAndSaysSo) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  const LabelledSample sample = sample_of(rig);
  // The model has 98, the gyro saw 0.98 less: the command is 2.98 too fast, and all else is small.
  EXPECT_NEAR(sample.rate_shaft_dps, 98.0, 0.3);
  EXPECT_NEAR(sample.rate_commanded_uncertainty_dps, std::hypot(2.98, 0.1, 0.11), 0.3);
  EXPECT_LT(sample.rate_corrected_uncertainty_dps, 0.5);
  EXPECT_GE(sample.rate_corrected_uncertainty_dps, std::hypot(0.1F, 0.098F));
}

TEST(CorrectedLabel, OfAServoTooWeakForItsSpeedIsStillWorthSomething) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  rig.config.response.speeds = {
      {.rate_dps = 100.0, .residual_dps = -20.0, .spread_dps = 0.4, .contradicts = true}};
  const LabelledSample sample = sample_of(rig);
  EXPECT_FALSE(sample.valid);
  EXPECT_NEAR(sample.rate_corrected_dps, 0.98 * 80.0, 0.1);
  EXPECT_LT(sample.rate_corrected_uncertainty_dps, 1.0);
  EXPECT_GT(sample.rate_commanded_uncertainty_dps, 20.0);
}

TEST(CorrectedLabel, FollowsTheGainAlongTheTravel) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  rig.config.response.speeds.clear();
  rig.config.response.gain = {1.1, 0.9};  // over 2160 deg; the shaft starts at -900
  const auto samples = rig.run(12.0);
  for (const std::size_t frame : {20U, 50U, 80U}) {
    const LabelledSample& sample = samples.at(frame);
    const double middle_s =
        seconds(sample.exposure_begin + (sample.exposure_end - sample.exposure_begin) / 2);
    const double gain = 1.0 - 0.1 * (-900.0 + 100.0 * middle_s) / 1080.0;
    EXPECT_NEAR(sample.rate_corrected_dps, 0.98 * gain * 100.0, 0.2) << frame;
  }
}

TEST(CorrectedLabel, OfAShaftThatHardlyTurnsIsOnTheScaleOfTheServo) {
  ScriptedRig rig;
  rig.config.response = slow_response();
  rig.rate_dps = [](double) { return 0.2; };
  EXPECT_NEAR(sample_of(rig).rate_corrected_dps, 0.98 * 0.2, 0.05);
}

TEST(CorrectedLabel, IsUnknownWithoutTelemetry) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double) { return false; };
  for (const LabelledSample& sample : rig.run(1.0)) {
    EXPECT_TRUE(std::isnan(sample.rate_corrected_dps));
    EXPECT_TRUE(std::isnan(sample.rate_corrected_half_dps[0]));
    EXPECT_TRUE(std::isnan(sample.rate_commanded_uncertainty_dps));
    EXPECT_TRUE(std::isnan(sample.rate_corrected_uncertainty_dps));
  }
}

}  // namespace
}  // namespace thermorig::labels

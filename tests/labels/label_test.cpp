// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

/// The first sample whose exposure ends at `end_s`.
const LabelledSample& ending_at(const std::vector<LabelledSample>& samples, double end_s) {
  for (const LabelledSample& sample : samples)
    if (std::abs(seconds(sample.exposure_end) - end_s) < 1e-9) return sample;
  ADD_FAILURE() << "no sample ends at " << end_s;
  static const LabelledSample none;
  return none;
}

TEST(Label, OfASteadySweepIsItsSpeed) {
  const auto samples = ScriptedRig().run(2.0);
  const LabelledSample& sample = ending_at(samples, 1.0);
  EXPECT_EQ(sample.rate_label_dps, 100.0F);
  EXPECT_EQ(sample.rate_label_min_dps, 100.0F);
  EXPECT_EQ(sample.rate_label_max_dps, 100.0F);
  EXPECT_EQ(sample.leg, 1);
  EXPECT_EQ(sample.reason_bits, 0U);
  EXPECT_TRUE(sample.valid);
}

TEST(Label, IsTheExactMeanOfASpeedThatRunsStraight) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 40.0 * t; };
  const LabelledSample sample = ending_at(rig.run(2.0), 1.0);  // exposed from 0.75 to 1.0
  EXPECT_NEAR(sample.rate_label_dps, 40.0 * 0.875, 1e-4);
  EXPECT_NEAR(sample.rate_label_min_dps, 30.0, 1e-4);
  EXPECT_NEAR(sample.rate_label_max_dps, 40.0, 1e-4);
}

TEST(Label, WeighsUnevenTelemetryByTime) {
  LabelConfig config;
  config.telemetry_gap_s = 1.0;
  Labeller labeller(config);
  const ScriptedRig rig;
  for (const auto& [t, rate] :
       std::vector<std::pair<double, double>>{{0.0, 0.0}, {0.8, 0.0}, {0.9, 60.0}, {1.1, 20.0}}) {
    TimedServo servo = rig.servo_at(t);
    servo.state.rate_dps = rate;
    labeller.add(servo);
  }
  labeller.add(rig.frame_at(1.0, 0));
  // 0.05 s at 0, 0.1 s from 0 to 60, 0.1 s from 60 to 40
  EXPECT_NEAR(labeller.finish().at(0).rate_label_dps, (0.1 * 30.0 + 0.1 * 50.0) / 0.25, 1e-4);
}

TEST(Label, GivesTheAngleInTheMiddleOfTheNewestHalf) {
  ScriptedRig rig;
  rig.angle_deg = [](double t) { return -200.0 + 100.0 * t; };
  const LabelledSample sample = ending_at(rig.run(2.0), 1.0);
  EXPECT_NEAR(seconds(sample.time), 0.9375, 1e-9);
  EXPECT_NEAR(sample.angle_label_deg, -200.0 + 93.75, 1e-3);
}

TEST(Label, AveragesTheGyroSamplesOfTheExposure) {
  ScriptedRig rig;
  rig.gyro_dps = [](double t) { return t < 0.875 ? 10.0 : 20.0; };
  const LabelledSample sample = ending_at(rig.run(2.0), 1.0);
  EXPECT_EQ(sample.gyro_count, 50);
  EXPECT_NEAR(sample.rate_gyro_dps, 15.0, 1e-5);
}

TEST(Label, AGyroSampleAtTheEdgeBelongsToOneOfTwoNeighbours) {
  ScriptedRig rig;
  rig.offset_s = 0.0;  // samples fall on both edges
  EXPECT_EQ(ending_at(rig.run(2.0), 1.0).gyro_count, 50);
}

TEST(Label, OfASteadySpeedIsAsSureAsTelemetryCounts) {
  ScriptedRig rig;
  rig.uncertainty_s = 0.004;
  EXPECT_NEAR(ending_at(rig.run(2.0), 1.0).label_uncertainty_dps, 0.01 / std::sqrt(12.0), 1e-7);
}

TEST(Label, OfAChangingSpeedIsAsUnsureAsItsTime) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 40.0 * t; };
  rig.uncertainty_s = 0.004;
  const double expected = std::hypot(40.0 * 0.004 * std::sqrt(2.0), 0.01 / std::sqrt(12.0));
  EXPECT_NEAR(ending_at(rig.run(2.0), 1.0).label_uncertainty_dps, expected, 1e-5);
}

TEST(Label, IsUnknownWithoutTelemetry) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double) { return false; };
  for (const LabelledSample& sample : rig.run(1.0)) {
    EXPECT_TRUE(std::isnan(sample.rate_label_dps));
    EXPECT_TRUE(std::isnan(sample.rate_label_min_dps));
    EXPECT_TRUE(std::isnan(sample.rate_label_max_dps));
    EXPECT_TRUE(std::isnan(sample.angle_label_deg));
    EXPECT_TRUE(std::isnan(sample.label_uncertainty_dps));
    EXPECT_EQ(sample.leg, 0);
    EXPECT_TRUE(has(sample, Reason::servo_lost));
    EXPECT_TRUE(has(sample, Reason::outside_leg));
  }
}

TEST(Label, IsUnknownWhereTelemetryHasAHole) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 0.9 || t > 0.97; };
  const auto samples = rig.run(2.0);
  EXPECT_TRUE(std::isnan(ending_at(samples, 1.0).rate_label_dps));
  EXPECT_TRUE(std::isnan(ending_at(samples, 0.9375 + 0.1875).rate_label_dps));  // exposed from 0.875
  EXPECT_EQ(ending_at(samples, 1.25).rate_label_dps, 100.0F);                   // exposed from 1.0
}

TEST(Label, IsUnknownUntilTelemetryReachesTheEndOfTheExposure) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 0.99; };
  EXPECT_TRUE(std::isnan(ending_at(rig.run(2.0), 1.0).rate_label_dps));
}

}  // namespace
}  // namespace thermorig::labels

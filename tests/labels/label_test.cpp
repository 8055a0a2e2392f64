// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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
  EXPECT_NEAR(sample.rate_commanded_dps, 100.0, 1e-2);
  EXPECT_NEAR(sample.rate_shaft_dps, 100.0, 0.5);  // the ripple of 50 pulses a second over 12.5 of them
  EXPECT_NEAR(sample.rate_shaft_min_dps, 100.0, 0.5);
  EXPECT_NEAR(sample.rate_shaft_max_dps, 100.0, 0.5);
  EXPECT_LE(sample.rate_shaft_min_dps, sample.rate_shaft_max_dps);
  EXPECT_EQ(sample.leg, 1);
  EXPECT_EQ(sample.reason_bits, 0U);
  EXPECT_TRUE(sample.valid);
}

TEST(Label, TheCommandedOneIsTheExactMeanOfASpeedThatRunsStraight) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 40.0 * t; };
  const LabelledSample sample = ending_at(rig.run(2.0), 1.0);  // exposed from 0.75 to 1.0
  EXPECT_NEAR(sample.rate_commanded_dps, 40.0 * 0.875, 1e-4);
}

TEST(Label, OfAChangingSpeedLagsAsTheServoDoes) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 40.0 * t; };
  rig.config.response = ServoResponse{.fitted = true};
  rig.config.response.delay_s = 0.012;
  rig.config.response.loop_hz = 6.0;
  rig.config.response.scale.value = 1.02;
  const LabelledSample sample = ending_at(rig.run(3.0), 2.0);
  // The pulse shows the command of 1 ms before it starts, ends 1.3 ms later (its width is about 0.8 ms),
  // holds for 20 ms; then the delay and the loop's own lag.
  const double lag_s = 0.001 + 0.0008 + 0.010 + 0.012 + 1.4 / (2.0 * std::numbers::pi * 6.0);
  EXPECT_NEAR(sample.rate_shaft_dps, 1.02 * 40.0 * (1.875 - lag_s), 0.15);
  EXPECT_NEAR(sample.rate_shaft_min_dps, 1.02 * 40.0 * (1.76 - lag_s), 0.3);
  EXPECT_NEAR(sample.rate_shaft_max_dps, 1.02 * 40.0 * (1.99 - lag_s), 0.3);
}

TEST(Label, OfEachHalfIsOverItsOwnExposure) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 40.0 * t; };
  rig.gyro_dps = [](double t) { return t < 1.875 ? 10.0 : 20.0; };
  const LabelledSample sample = ending_at(rig.run(3.0), 2.0);  // frame 15: the odd half is the newest
  EXPECT_NEAR(sample.rate_commanded_half_dps[0], 40.0 * 1.8125, 1e-3);
  EXPECT_NEAR(sample.rate_commanded_half_dps[1], 40.0 * 1.9375, 1e-3);
  EXPECT_NEAR(sample.rate_shaft_half_dps[1] - sample.rate_shaft_half_dps[0], 40.0 * 0.125, 0.5);
  EXPECT_NEAR((sample.rate_shaft_half_dps[0] + sample.rate_shaft_half_dps[1]) / 2.0, sample.rate_shaft_dps,
              1e-3);
  EXPECT_NEAR(sample.rate_gyro_half_dps[0], 10.0, 1e-5);
  EXPECT_NEAR(sample.rate_gyro_half_dps[1], 20.0, 1e-5);
}

TEST(Label, CoarsePulsesDoNotMakeTheCommandedSpeedNoisy) {
  ScriptedRig rig;
  rig.rate_dps = [](double) { return 20.0; };
  const auto quantised = [](TimedServo servo) {
    servo.state.pulse_us = std::round(servo.state.pulse_us * 2.0F) / 2.0F;  // 0.54 deg on a winch
    return servo;
  };
  Labeller labeller(rig.config);
  for (int i = 0; i < 300; ++i) labeller.add(quantised(rig.servo_at(rig.offset_s + 0.01 * i)));
  for (int i = 0; i < 12; ++i) labeller.add(rig.frame_at(1.0 + 0.125 * i, i));
  for (const LabelledSample& sample : labeller.finish())
    EXPECT_NEAR(sample.rate_commanded_dps, 20.0, 0.25) << seconds(sample.exposure_end);
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
  EXPECT_NEAR(labeller.finish().at(0).rate_commanded_dps, (0.1 * 30.0 + 0.1 * 50.0) / 0.25, 1e-4);
}

TEST(Label, GivesTheAngleInTheMiddleOfTheNewestHalf) {
  ScriptedRig rig;
  rig.angle_deg = [](double t) { return -200.0 + 100.0 * t; };
  const LabelledSample sample = ending_at(rig.run(2.0), 1.0);
  EXPECT_NEAR(seconds(sample.time), 0.9375, 1e-9);
  EXPECT_NEAR(sample.angle_commanded_deg, -200.0 + 93.75, 1e-3);
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

/// A response that leaves no doubt but what a test adds.
ServoResponse certain_response() {
  ServoResponse response;
  response.fitted = true;
  response.delay_uncertainty_s = 0.0;
  response.scale.uncertainty = 0.0;
  response.gyro_ratio.uncertainty = 0.0;
  response.residual_dps = 0.0;
  return response;
}

TEST(Label, OfASteadySpeedIsAsUnsureAsTheScale) {
  ScriptedRig rig;
  rig.config.response = certain_response();
  rig.config.response.scale = {0.98, 0.015};
  EXPECT_NEAR(ending_at(rig.run(2.0), 1.0).rate_shaft_uncertainty_dps, 100.0 * 0.015, 0.02);
}

TEST(Label, OfAChangingSpeedIsAsUnsureAsItsTime) {
  ScriptedRig rig;
  rig.rate_dps = [](double t) { return 200.0 * t; };
  rig.config.response = certain_response();
  rig.uncertainty_s = 0.004;  // of the frame's clock and of telemetry's
  rig.config.latency_uncertainty_s = 0.003;
  rig.config.response.delay_uncertainty_s = 0.002;
  const double time_s = std::hypot(std::hypot(0.004, 0.004), 0.003, 0.002);
  const double uncertainty_dps = ending_at(rig.run(2.0), 1.0).rate_shaft_uncertainty_dps;
  EXPECT_GT(uncertainty_dps, 0.95 * 200.0 * time_s);
  EXPECT_LT(uncertainty_dps, 1.4 * 200.0 * time_s);  // the ripple adds
}

TEST(Label, IsAsUnsureAsTheResponsesResidualAtItsSpeed) {
  ScriptedRig rig;
  rig.config.response = certain_response();
  rig.config.response.residual_dps = 9.0;
  rig.config.response.speeds = {{.rate_dps = -100.0, .residual_dps = 7.0},
                                {.rate_dps = 100.0, .residual_dps = 0.3, .spread_dps = 0.4},
                                {.rate_dps = 150.0, .residual_dps = 5.0}};
  EXPECT_NEAR(ending_at(rig.run(2.0), 1.0).rate_shaft_uncertainty_dps, 0.5, 0.01);
}

TEST(Label, OfACalibratedCameraIsAsUnsureAsItsLatencyAlone) {
  RigProfile profile;
  profile.camera.output_rate_hz = 1e6;  // how its rows are read hardly matters
  profile.camera.link.latency_uncertainty_s = 0.0003;
  profile.servo.link.latency_uncertainty_s = 0.0004;
  SyncReport sync;
  sync.clock[Device::gyro].latency_uncertainty_s = 0.002;
  EXPECT_NEAR(label_config(profile, sync, false).latency_uncertainty_s, 0.0005,
              1e-9);  // by the servo's clock
  sync.servo.fitted = true;
  EXPECT_NEAR(label_config(profile, sync, false).latency_uncertainty_s, std::hypot(0.0003, 0.002), 1e-9);
  profile.camera.link.latency_measured_utc = "2026-07-25T14:35:12Z";  // against the gyro
  EXPECT_NEAR(label_config(profile, sync, false).latency_uncertainty_s, 0.0003, 1e-9);
}

TEST(Label, OfACameraThatItsImagesShiftedIsAsUnsureAsTheShift) {
  const RigProfile profile;
  SyncReport sync;
  sync.camera_offset = {.offset_s = Estimate{0.004, 0.0003}, .why_not = {}, .halves = 200, .applied = true};
  sync.clock[Device::camera].latency_uncertainty_s = 0.002;
  const double by_servo_s = label_config(profile, sync, false).latency_uncertainty_s;
  EXPECT_NEAR(by_servo_s, std::hypot(0.002, profile.servo.link.latency_uncertainty_s), 1e-9);
  sync.servo.fitted = true;
  EXPECT_NEAR(label_config(profile, sync, false).latency_uncertainty_s, 0.0003, 1e-9);
}

TEST(Label, WithoutAFitContainsWhatServosAreKnownFor) {
  const auto samples = ScriptedRig().run(2.0);
  EXPECT_GT(ending_at(samples, 1.0).rate_shaft_uncertainty_dps, 100.0F * 0.015F);
  EXPECT_LT(ending_at(samples, 1.0).rate_shaft_uncertainty_dps, 100.0F * 0.04F);
}

TEST(Label, IsUnknownWithoutTelemetry) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double) { return false; };
  for (const LabelledSample& sample : rig.run(1.0)) {
    EXPECT_TRUE(std::isnan(sample.rate_shaft_dps));
    EXPECT_TRUE(std::isnan(sample.rate_shaft_min_dps));
    EXPECT_TRUE(std::isnan(sample.rate_shaft_max_dps));
    EXPECT_TRUE(std::isnan(sample.angle_commanded_deg));
    EXPECT_TRUE(std::isnan(sample.rate_shaft_uncertainty_dps));
    EXPECT_EQ(sample.leg, 0);
    EXPECT_TRUE(has(sample, Reason::servo_lost));
    EXPECT_TRUE(has(sample, Reason::outside_leg));
  }
}

TEST(Label, IsUnknownWhereTelemetryHasAHole) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 0.9 || t > 0.97; };
  const auto samples = rig.run(2.0);
  EXPECT_TRUE(std::isnan(ending_at(samples, 1.0).rate_shaft_dps));
  EXPECT_TRUE(std::isnan(ending_at(samples, 0.9375 + 0.1875).rate_shaft_dps));  // exposed from 0.875
  EXPECT_NEAR(ending_at(samples, 1.25).rate_shaft_dps, 100.0, 1.0);             // exposed from 1.0
  EXPECT_TRUE(std::isnan(ending_at(samples, 1.0).rate_commanded_dps));
}

TEST(Label, IsUnknownUntilTelemetryReachesTheEndOfTheExposure) {
  ScriptedRig rig;
  rig.telemetry_comes = [](double t) { return t < 0.99; };
  EXPECT_TRUE(std::isnan(ending_at(rig.run(2.0), 1.0).rate_shaft_dps));
}

}  // namespace
}  // namespace thermorig::labels

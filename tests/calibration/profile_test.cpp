// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

const std::string utc = "2026-07-25T14:35:12Z";

TEST(CalibratedProfile, TakesWhatWasMeasuredAndLeavesPortsAndGeometry) {
  RigProfile from, into;
  from.camera.link.baud = 115200;
  from.servo.travel_deg = 180;
  apply(LatencyResult{.camera_latency_s = {0.0213, 0.0004}}, utc, from);
  take_calibrations(from, into);
  EXPECT_EQ(into.camera.link.latency_s, 0.0213);
  EXPECT_EQ(into.camera.link.latency_measured_utc, utc);
  EXPECT_EQ(into.camera.link.baud, 460800U);
  EXPECT_EQ(into.servo.travel_deg, 2160.0);
}

TEST(CalibratedProfile, TakesHowTheDataAreToBeReadWhereNothingElseWasMeasured) {
  RigProfile from, into;
  from.gyro.protocol = into.gyro.protocol = "text";
  from.gyro.text.scale_dps = 57.29578;
  from.gyro.sign = -1;
  from.gyro.scale = 1.02;
  from.camera.mirrored = !into.camera.mirrored;
  from.camera.field_of_view_deg = 110.0;
  RigProfile measured = into;
  apply(OrientationResult{.gyro_axis = 2, .gyro_sign = 1, .mirrored = into.camera.mirrored}, utc, measured);
  apply(ScaleResult{.gyro_scale = {1.01, 0.001}, .servo_scale = {}}, utc, measured);
  take_calibrations(from, into);
  EXPECT_EQ(into.gyro.text.scale_dps, 57.29578);
  EXPECT_EQ(into.gyro.sign, -1);
  EXPECT_EQ(into.gyro.scale, 1.02);
  EXPECT_EQ(into.camera.mirrored, from.camera.mirrored);
  EXPECT_EQ(into.camera.field_of_view_deg, 110.0);
  take_calibrations(from, measured);
  EXPECT_EQ(measured.gyro.text.scale_dps, 57.29578);
  EXPECT_EQ(measured.gyro.sign, 1);
  EXPECT_EQ(measured.gyro.scale, 1.01);
  EXPECT_NE(measured.camera.mirrored, from.camera.mirrored);
}

TEST(CalibratedProfile, DoesNotTakeColumnsFromAGyroOfAnotherProtocol) {
  RigProfile from, into;
  from.gyro.protocol = "text";
  from.gyro.text.scale_dps = 57.29578;
  take_calibrations(from, into);
  EXPECT_EQ(into.gyro.text.scale_dps, 1.0);
}

TEST(CalibratedProfile, TakesEverythingThatWasMeasured) {
  RigProfile from, into;
  from.gyro.link.latency_s = 0.0035;
  apply(OrientationResult{.gyro_axis = 0, .gyro_sign = -1, .mirrored = false}, utc, from);
  apply(BiasResult{.bias_dps = {0.5, 0.01}}, utc, from);
  apply(LatencyResult{.camera_latency_s = {0.0213, 0.0004}}, utc, from);
  apply(ScaleResult{.gyro_scale = {1.01, 0.001}, .servo_scale = Estimate{0.99, 0.002}}, utc, from);
  apply(LensResult{.pitch_scale = {1.02, 0.002}, .distortion = Estimate{-0.03, 0.005}}, utc, from);
  take_calibrations(from, into);
  EXPECT_EQ(into.camera.pitch_scale, 1.02);
  EXPECT_EQ(into.camera.pitch_scale_uncertainty, 0.002);
  EXPECT_EQ(into.camera.distortion, -0.03);
  EXPECT_EQ(into.camera.lens_measured_utc, utc);
  EXPECT_EQ(into.gyro.axis, 0);
  EXPECT_EQ(into.gyro.sign, -1);
  EXPECT_FALSE(into.camera.mirrored);
  EXPECT_EQ(into.gyro.bias_dps, 0.5);
  EXPECT_EQ(into.gyro.scale, 1.01);
  EXPECT_EQ(into.servo.scale, 0.99);
  EXPECT_EQ(into.servo.scale_measured_utc, utc);
  EXPECT_EQ(into.gyro.link.latency_s, 0.0035);  // the camera's was measured against it
}

TEST(CalibratedProfile, TakesALensForAnHonestOneInWhatItWasNotToldToBe) {
  RigProfile profile;
  profile.camera.roll_deg = 3.0;
  apply(
      LensResult{
          .pitch_scale = {1.01, 0.002}, .distortion = Estimate{0.01, 0.008}, .tilt_deg = Estimate{2.0, 0.4}},
      utc, profile);
  EXPECT_EQ(profile.camera.distortion, 0.0) << "within two standard deviations";
  EXPECT_EQ(profile.camera.tilt_deg, 2.0);
  EXPECT_EQ(profile.camera.roll_deg, 0.0) << "not told";
}

TEST(CalibratedProfile, LeavesTheBiasOfAnotherAxisAlone) {
  RigProfile from, into;
  apply(BiasResult{.bias_dps = {0.5, 0.01}}, utc, from);
  apply(OrientationResult{.gyro_axis = 0, .gyro_sign = 1, .mirrored = true}, utc, into);
  take_calibrations(from, into);
  EXPECT_EQ(into.gyro.bias_dps, 0.0);
}

TEST(CalibratedProfile, ForgetsBiasAndScaleOfAnAxisThatIsNoLongerTheServos) {
  RigProfile from, into;
  apply(OrientationResult{.gyro_axis = 1, .gyro_sign = 1, .mirrored = true}, utc, from);
  apply(BiasResult{.bias_dps = {0.5, 0.01}}, utc, into);
  apply(ScaleResult{.gyro_scale = {1.02, 0.001}, .servo_scale = {}}, utc, into);
  take_calibrations(from, into);
  EXPECT_EQ(into.gyro.axis, 1);
  EXPECT_EQ(into.gyro.bias_dps, 0.0);
  EXPECT_EQ(into.gyro.scale, 1.0);
  EXPECT_EQ(into.gyro.scale_measured_utc, "");
}

TEST(CalibratedProfile, TurnsTheBiasWithTheSignAndForgetsThatOfAnotherAxis) {
  RigProfile profile;
  apply(BiasResult{.bias_dps = {0.5, 0.01}}, utc, profile);
  apply(OrientationResult{.gyro_axis = 2, .gyro_sign = -1, .mirrored = true}, utc, profile);
  EXPECT_EQ(profile.gyro.bias_dps, -0.5);
  apply(OrientationResult{.gyro_axis = 1, .gyro_sign = -1, .mirrored = true}, utc, profile);
  EXPECT_EQ(profile.gyro.bias_dps, 0.0);
  EXPECT_EQ(profile.gyro.bias_measured_utc, "");
}

TEST(CombinedCalibrations, WeighBySurenessAndAreNoSurerThanTheyAgree) {
  const std::array<LatencyResult, 2> agreeing{LatencyResult{.camera_latency_s = {0.020, 0.001}},
                                              LatencyResult{.camera_latency_s = {0.023, 0.002}}};
  const LatencyResult all = combined(agreeing);
  EXPECT_NEAR(all.camera_latency_s.value, 0.0206, 1e-9);
  EXPECT_NEAR(all.camera_latency_s.uncertainty, 0.002 * std::sqrt(0.36), 1e-9);  // the scatter: 1.8 > 1
  const std::array<LatencyResult, 2> apart{LatencyResult{.camera_latency_s = {0.020, 0.0001}},
                                           LatencyResult{.camera_latency_s = {0.022, 0.0001}}};
  EXPECT_NEAR(combined(apart).camera_latency_s.uncertainty, 0.001, 1e-6);
}

TEST(CombinedCalibrations, RefuseOrientationsThatContradict) {
  const std::array<OrientationResult, 2> results{OrientationResult{.mirrored = true},
                                                 OrientationResult{.mirrored = false}};
  EXPECT_THROW(combined(results), Error);
}

TEST(CombinedCalibrations, AnEncodersErrorsAreMeansOfVectorsAndAsSureAsTheyAgree) {
  EncoderResult first{.encoder = {.once_cosine_deg = 1.0, .error_deg = 0.1}, .legs = 12};
  EncoderResult second{.encoder = {.once_sine_deg = 1.0, .error_deg = 0.1}, .legs = 10};
  const EncoderResult all = combined(std::array{first, second});
  EXPECT_NEAR(all.once_deg, std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(all.encoder.error_deg, 0.5, 1e-9);  // they differ by far more than they state
  EXPECT_EQ(all.legs, 22U);
  second.encoder.sign = -1;
  EXPECT_THROW(combined(std::array{first, second}), Error);
}

}  // namespace
}  // namespace thermorig::calibration

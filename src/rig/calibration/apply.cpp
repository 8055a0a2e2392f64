// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>

#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

/// Millionths are far below what any calibration tells, and a profile is read by people.
double rounded(double value) {
  return std::round(value * 1e6) / 1e6;
}

constexpr double widest_hz = 8000.0;  // that a profile can state: no filter to speak of

}  // namespace

void apply(const BiasResult& result, const std::string& utc, RigProfile& profile) {
  profile.gyro.bias_dps = rounded(result.bias_dps.value);
  profile.gyro.bias_uncertainty_dps = rounded(result.bias_dps.uncertainty);
  profile.gyro.bias_measured_utc = utc;
}

void apply(const LatencyResult& result, const std::string& utc, RigProfile& profile) {
  profile.camera.link.latency_s = rounded(result.camera_latency_s.value);
  profile.camera.link.latency_uncertainty_s = rounded(result.camera_latency_s.uncertainty);
  profile.camera.link.latency_measured_utc = utc;
}

void apply(const ScaleResult& result, const std::string& utc, RigProfile& profile) {
  profile.gyro.scale = rounded(result.gyro_scale.value);
  profile.gyro.scale_uncertainty = rounded(result.gyro_scale.uncertainty);
  profile.gyro.scale_measured_utc = utc;
  if (!result.servo_scale) return;
  profile.servo.scale = rounded(result.servo_scale->value);
  profile.servo.scale_uncertainty = rounded(result.servo_scale->uncertainty);
  profile.servo.scale_measured_utc = utc;
}

namespace {

/// Bias and scale of another axis say nothing about this one; with the other sign the bias has it too.
void turn_gyro(int axis, int sign, GyroProfile& gyro) {
  if (gyro.axis != axis) {
    const GyroProfile unknown;
    gyro.bias_dps = unknown.bias_dps;
    gyro.bias_uncertainty_dps = unknown.bias_uncertainty_dps;
    gyro.bias_measured_utc.clear();
    gyro.scale = unknown.scale;
    gyro.scale_uncertainty = unknown.scale_uncertainty;
    gyro.scale_measured_utc.clear();
  } else if (gyro.sign != sign) {
    gyro.bias_dps = -gyro.bias_dps;
  }
  gyro.axis = axis;
  gyro.sign = sign;
}

}  // namespace

void apply(const OrientationResult& result, const std::string& utc, RigProfile& profile) {
  turn_gyro(result.gyro_axis, result.gyro_sign, profile.gyro);
  profile.camera.mirrored = result.mirrored;
  profile.camera.orientation_measured_utc = utc;
}

void apply(const EncoderResult& result, const std::string& utc, RigProfile& profile) {
  EncoderProfile& encoder = profile.encoder;
  encoder.sign = result.encoder.sign;
  encoder.offset_deg = rounded(result.encoder.offset_deg);
  encoder.once_cosine_deg = rounded(result.encoder.once_cosine_deg);
  encoder.once_sine_deg = rounded(result.encoder.once_sine_deg);
  encoder.twice_cosine_deg = rounded(result.encoder.twice_cosine_deg);
  encoder.twice_sine_deg = rounded(result.encoder.twice_sine_deg);
  encoder.error_deg = rounded(result.encoder.error_deg);
  encoder.measured_utc = utc;
}

void apply(const LensResult& result, const std::string& utc, RigProfile& profile) {
  const auto value = [](const std::optional<Estimate>& told) {
    return told && is_not_plain(*told) ? rounded(told->value) : 0.0;
  };
  CameraProfile& camera = profile.camera;
  camera.pitch_scale = rounded(result.pitch_scale.value);
  camera.pitch_scale_uncertainty = rounded(result.pitch_scale.uncertainty);
  camera.distortion = value(result.distortion);
  camera.distortion_uncertainty =
      result.distortion ? rounded(result.distortion->uncertainty) : CameraProfile().distortion_uncertainty;
  camera.tilt_deg = value(result.tilt_deg);
  camera.roll_deg = value(result.roll_deg);
  camera.row_spread = value(result.row_spread);
  camera.lens_measured_utc = utc;
  if (!result.gyro_delay_s) return;
  GyroProfile& gyro = profile.gyro;
  gyro.filter_delay_s = 0.0;
  gyro.bandwidth_hz =
      std::min(widest_hz, rounded(GyroProfile::second_order_delay / result.gyro_delay_s->value));
}

namespace {

/// The camera's was measured against the gyro's, which belongs to it.
void take_latency(const RigProfile& from, RigProfile& into) {
  if (from.camera.link.latency_measured_utc.empty()) return;
  into.camera.link.latency_s = from.camera.link.latency_s;
  into.camera.link.latency_uncertainty_s = from.camera.link.latency_uncertainty_s;
  into.camera.link.latency_measured_utc = from.camera.link.latency_measured_utc;
  into.gyro.link.latency_s = from.gyro.link.latency_s;
  into.gyro.link.latency_uncertainty_s = from.gyro.link.latency_uncertainty_s;
}

void take_lens(const CameraProfile& from, CameraProfile& into) {
  if (from.lens_measured_utc.empty()) return;
  into.pitch_scale = from.pitch_scale;
  into.pitch_scale_uncertainty = from.pitch_scale_uncertainty;
  into.distortion = from.distortion;
  into.distortion_uncertainty = from.distortion_uncertainty;
  into.tilt_deg = from.tilt_deg;
  into.roll_deg = from.roll_deg;
  into.row_spread = from.row_spread;
  into.lens_measured_utc = from.lens_measured_utc;
}

void take_gyro(const GyroProfile& from, GyroProfile& into) {
  if (from.bandwidth_hz > 0.0) {
    into.bandwidth_hz = from.bandwidth_hz;
    into.filter_delay_s = from.filter_delay_s;
  }
  if (!from.scale_measured_utc.empty()) {
    into.scale = from.scale;
    into.scale_uncertainty = from.scale_uncertainty;
    into.scale_measured_utc = from.scale_measured_utc;
  }
  if (from.bias_measured_utc.empty()) return;
  into.bias_dps = from.bias_dps;
  into.bias_uncertainty_dps = from.bias_uncertainty_dps;
  into.bias_measured_utc = from.bias_measured_utc;
}

/// How the data are to be read: of two assumptions the later one holds.
void take_statements(const RigProfile& from, RigProfile& into) {
  into.camera.field_of_view_deg = from.camera.field_of_view_deg;
  if (from.gyro.protocol == into.gyro.protocol) {
    into.gyro.text = from.gyro.text;
    into.gyro.settings = from.gyro.settings;
  }
  if (into.camera.orientation_measured_utc.empty()) {
    turn_gyro(from.gyro.axis, from.gyro.sign, into.gyro);
    into.camera.mirrored = from.camera.mirrored;
  }
  if (!into.gyro.scale_measured_utc.empty()) return;
  into.gyro.scale = from.gyro.scale;
  into.gyro.scale_uncertainty = from.gyro.scale_uncertainty;
}

}  // namespace

/// Orientation first: bias and scale belong to the axis and sign that they were measured with.
void take_calibrations(const RigProfile& from, RigProfile& into) {
  take_statements(from, into);
  if (!from.camera.orientation_measured_utc.empty()) {
    turn_gyro(from.gyro.axis, from.gyro.sign, into.gyro);
    into.camera.mirrored = from.camera.mirrored;
    into.camera.orientation_measured_utc = from.camera.orientation_measured_utc;
  }
  take_latency(from, into);
  take_lens(from.camera, into.camera);
  if (into.gyro.axis == from.gyro.axis && into.gyro.sign == from.gyro.sign) take_gyro(from.gyro, into.gyro);
  if (!from.encoder.measured_utc.empty()) into.encoder = from.encoder;
  if (from.servo.scale_measured_utc.empty()) return;
  into.servo.scale = from.servo.scale;
  into.servo.scale_uncertainty = from.servo.scale_uncertainty;
  into.servo.scale_measured_utc = from.servo.scale_measured_utc;
}

}  // namespace thermorig::calibration

// SPDX-License-Identifier: MIT
#include "thermorig/calibration/calibration.h"

namespace thermorig::calibration {

void apply(const BiasResult& result, const std::string& utc, RigProfile& profile) {
  profile.gyro.bias_dps = result.bias_dps.value;
  profile.gyro.bias_uncertainty_dps = result.bias_dps.uncertainty;
  profile.gyro.bias_measured_utc = utc;
}

void apply(const LatencyResult& result, const std::string& utc, RigProfile& profile) {
  profile.camera.link.latency_s = result.camera_latency_s.value;
  profile.camera.link.latency_uncertainty_s = result.camera_latency_s.uncertainty;
  profile.camera.link.latency_measured_utc = utc;
}

void apply(const ScaleResult& result, const std::string& utc, RigProfile& profile) {
  profile.gyro.scale = result.gyro_scale.value;
  profile.gyro.scale_uncertainty = result.gyro_scale.uncertainty;
  profile.gyro.scale_measured_utc = utc;
  if (!result.servo_scale) return;
  profile.servo.scale = result.servo_scale->value;
  profile.servo.scale_uncertainty = result.servo_scale->uncertainty;
  profile.servo.scale_measured_utc = utc;
}

/// A bias that was measured about another axis, or with the other sign, says nothing about this one.
void apply(const OrientationResult& result, const std::string& utc, RigProfile& profile) {
  GyroProfile& gyro = profile.gyro;
  if (gyro.axis != result.gyro_axis) {
    const GyroProfile unknown;
    gyro.bias_dps = unknown.bias_dps;
    gyro.bias_uncertainty_dps = unknown.bias_uncertainty_dps;
    gyro.bias_measured_utc.clear();
    gyro.scale = unknown.scale;
    gyro.scale_uncertainty = unknown.scale_uncertainty;
    gyro.scale_measured_utc.clear();
  } else if (gyro.sign != result.gyro_sign) {
    gyro.bias_dps = -gyro.bias_dps;
  }
  gyro.axis = result.gyro_axis;
  gyro.sign = result.gyro_sign;
  profile.camera.mirrored = result.mirrored;
  profile.camera.orientation_measured_utc = utc;
}

namespace {

void take_latency(const PortProfile& from, PortProfile& into) {
  if (from.latency_measured_utc.empty()) return;
  into.latency_s = from.latency_s;
  into.latency_uncertainty_s = from.latency_uncertainty_s;
  into.latency_measured_utc = from.latency_measured_utc;
}

void take_gyro(const GyroProfile& from, GyroProfile& into) {
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

}  // namespace

/// Orientation first: bias and scale belong to the axis and sign that they were measured with.
void take_calibrations(const RigProfile& from, RigProfile& into) {
  if (!from.camera.orientation_measured_utc.empty()) {
    into.gyro.axis = from.gyro.axis;
    into.gyro.sign = from.gyro.sign;
    into.camera.mirrored = from.camera.mirrored;
    into.camera.orientation_measured_utc = from.camera.orientation_measured_utc;
  }
  for (const Device device : all_devices) take_latency(from.link(device), into.link(device));
  if (into.gyro.axis == from.gyro.axis && into.gyro.sign == from.gyro.sign) take_gyro(from.gyro, into.gyro);
  if (from.servo.scale_measured_utc.empty()) return;
  into.servo.scale = from.servo.scale;
  into.servo.scale_uncertainty = from.servo.scale_uncertainty;
  into.servo.scale_measured_utc = from.servo.scale_measured_utc;
}

}  // namespace thermorig::calibration

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/label_config.h"

#include <cmath>

namespace thermorig::labels {

namespace {
/// Of the constant between the camera's clock and the one that the servo model hangs on: a fitted response
/// hangs on the gyro's, against which the camera's latency is measured; an assumed one on the servo's.
double time_uncertainty_s(const RigProfile& profile, const std::optional<SyncReport>& sync,
                          bool merges_halves) {
  const bool by_gyro = sync && (sync->servo.fitted || !profile.servo.is_there());
  const bool shifted = sync && sync->camera_offset.applied && sync->camera_offset.offset_s;
  if (by_gyro && shifted) return sync->camera_offset.offset_s->uncertainty;
  const double of_profile_s = latency_uncertainty_s(profile.camera, merges_halves);
  if (by_gyro && !profile.camera.link.latency_measured_utc.empty()) return of_profile_s;
  const double camera_s = shifted ? sync->clock[Device::camera].latency_uncertainty_s : of_profile_s;
  const double other_s =
      by_gyro ? sync->clock[Device::gyro].latency_uncertainty_s : profile.servo.link.latency_uncertainty_s;
  return std::hypot(camera_s, other_s);
}
}  // namespace

LabelConfig label_config(const RigProfile& profile, const std::optional<SyncReport>& sync,
                         bool merges_halves) {
  LabelConfig config;
  config.settle_s = profile.servo.settle_s;
  config.gyro_rate_hz = profile.gyro.output_rate_hz;
  config.stop_margin_deg = profile.servo.stop_margin_deg;
  config.travel_deg = profile.servo.kind == ServoKind::positional ? profile.servo.travel_deg : 0.0;
  config.by_gyro = !profile.servo.is_there();
  config.servo = profile.servo;
  config.gyro_profile = profile.gyro;
  config.latency_uncertainty_s = time_uncertainty_s(profile, sync, merges_halves);
  // Live nothing has judged the sensor yet: the gyro judges each frame by itself.
  config.by_sensor = sync ? sync->shaft.used : !profile.encoder.measured_utc.empty();
  config.sensor_error_deg = sync ? sync->shaft.error_deg : profile.encoder.error_deg;
  config.sensor_latency_uncertainty_s = profile.encoder.latency_uncertainty_s;
  if (!sync) return config;
  config.response = sync->servo;
  config.gyro = sync->gyro;
  config.gyro_gaps = sync->clock[Device::gyro].gaps;
  return config;
}

}  // namespace thermorig::labels

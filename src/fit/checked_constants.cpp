// SPDX-License-Identifier: MIT
#include "checked_constants.h"
#include "thermorig/sensors/camera_protocol.h"

#include <cmath>
#include <numbers>

namespace thermorig::fit {

namespace {

Estimate weighed(const Estimate& a, const Estimate& b) {
  const double square_a = a.uncertainty * a.uncertainty, square_b = b.uncertainty * b.uncertainty;
  if (!(square_a + square_b > 0.0)) return a;
  const double share_b = square_a / (square_a + square_b);
  return {a.value + share_b * (b.value - a.value), std::sqrt(share_b) * b.uncertainty};
}

void shift_times(double shift_s, ClockFit& clock) {
  for (TimeEstimate& estimate : clock.times) estimate.time -= from_s(shift_s);
  clock.report.latency_s += shift_s;
}

/// What a filter that no profile states may have added to either of two measurements.
double unstated_filter_s(const GyroErrors& errors) {
  const bool is_stated = errors.filter_source == "profile" || errors.filter_source == "device";
  return is_stated ? 0.0 : std::numbers::sqrt2 * errors.filter_delay_s.uncertainty;
}

}  // namespace

void apply_turns(const motion::TurnResult& turns, GyroErrors& errors) {
  errors.scale_by_turns = turns.gyro_scale;
  errors.scale_why_not = turns.why_not;
  if (!turns.gyro_scale) return;
  errors.scale_contradicts = errors.scale_calibrated && contradict(errors.scale, *turns.gyro_scale);
  errors.scale = errors.scale_contradicts ? *turns.gyro_scale : weighed(errors.scale, *turns.gyro_scale);
}

void apply_filter_delay(const GyroErrors& errors, ClockFit& gyro) {
  shift_times(errors.filter_delay_s.value, gyro);
  gyro.report.latency_uncertainty_s =
      std::hypot(gyro.report.latency_uncertainty_s, errors.filter_delay_s.uncertainty);
}

void apply_camera_offset(const CameraProfile& profile, const GyroErrors& errors, const ClockReport& gyro,
                         CameraOffset& offset, ClockFit& camera) {
  const bool is_calibrated = !profile.link.latency_measured_utc.empty();
  const Estimate assumed{0.0, sensors::latency_uncertainty_s(profile)};
  Estimate left = assumed;
  if (offset.offset_s && !camera.times.empty()) {
    const Estimate& seen = *offset.offset_s;
    const bool is_elsewhere = is_calibrated && contradict(assumed, seen);
    const Estimate with_filter{seen.value, std::hypot(seen.uncertainty, unstated_filter_s(errors))};
    offset.contradicts = is_calibrated && contradict(assumed, with_filter);
    offset.applied = is_elsewhere || (!is_calibrated && seen.uncertainty < assumed.uncertainty);
    if (offset.applied) left = is_elsewhere ? seen : weighed(assumed, seen);
  }
  shift_times(left.value, camera);
  const bool is_by_gyro = offset.applied || is_calibrated;
  camera.report.latency_uncertainty_s =
      is_by_gyro ? std::hypot(left.uncertainty, gyro.latency_uncertainty_s) : left.uncertainty;
}

}  // namespace thermorig::fit

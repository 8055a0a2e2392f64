// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "format.h"
#include "thermorig/core/sync.h"

namespace thermorig::session {

// The attributes of /sync and of its groups: one list for writing (report const), reading and the checksum.
// Visit takes a name and a reference to a std::string, double, bool, std::uint32_t or std::optional<double>.

template <typename Visit, typename Report>
void clock_attributes(Visit& visit, Report& clock, FormatVersion version) {
  visit("method", clock.method);
  visit("rate_hz", clock.rate_hz);
  visit("skew_ppm", clock.skew_ppm);
  visit("wander_ppm", clock.wander_ppm);
  visit("late_p50_us", clock.late_p50_us);
  visit("late_p95_us", clock.late_p95_us);
  visit("late_max_us", clock.late_max_us);
  visit("uncertainty_us", clock.uncertainty_us);
  visit("bound_us", clock.bound_us);
  visit("bound_median_us", clock.bound_median_us);
  if (version >= with_checked_constants) visit("bound_wander_ppm", clock.bound_wander_ppm);
  if (version >= with_needed_wander) visit("needed_wander_ppm", clock.needed_wander_ppm);
  if (version >= with_witnesses) visit("own_time_unused", clock.own_time_unused);
  visit("largest_constant_delay_s", clock.largest_constant_delay_s);
  visit("latency_s", clock.latency_s);
  visit("latency_uncertainty_s", clock.latency_uncertainty_s);
}

/// A value that may be unknown, as two attributes.
template <typename Visit>
void estimate_attributes(Visit& visit, const char* name, const char* uncertainty_name,
                         const std::optional<Estimate>& estimate) {
  const auto value = estimate ? std::optional(estimate->value) : std::nullopt;
  const auto uncertainty = estimate ? std::optional(estimate->uncertainty) : std::nullopt;
  visit(name, value);
  visit(uncertainty_name, uncertainty);
}

template <typename Visit>
void estimate_attributes(Visit& visit, const char* name, const char* uncertainty_name,
                         std::optional<Estimate>& estimate) {
  std::optional<double> value, uncertainty;
  if (estimate) value = estimate->value, uncertainty = estimate->uncertainty;
  visit(name, value);
  visit(uncertainty_name, uncertainty);
  estimate.reset();
  if (value && uncertainty) estimate = Estimate{*value, *uncertainty};
}

/// What the session's own data say of the profile's constants.
template <typename Visit, typename Report>
void constant_attributes(Visit& visit, Report& sync) {
  visit("camera_offset_contradicts", sync.camera_offset.contradicts);
  estimate_attributes(visit, "camera_row_delay_s", "camera_row_delay_uncertainty_s",
                      sync.camera_offset.row_delay_s);
  estimate_attributes(visit, "gyro_scale_by_turns", "gyro_scale_by_turns_uncertainty",
                      sync.gyro.scale_by_turns);
  visit("gyro_scale_why_not", sync.gyro.scale_why_not);
  visit("gyro_scale_contradicts", sync.gyro.scale_contradicts);
  visit("gyro_filter_delay_s", sync.gyro.filter_delay_s.value);
  visit("gyro_filter_delay_uncertainty_s", sync.gyro.filter_delay_s.uncertainty);
  visit("gyro_filter_source", sync.gyro.filter_source);
  visit("gyro_filter_contradicts", sync.gyro.filter_contradicts);
}

/// A witness is stored by its name.
template <typename Visit>
void witness_attribute(Visit& visit, const Witness& witness) {
  const std::string name(name_of(witness));
  visit("witness_outlier", name);
}

template <typename Visit>
void witness_attribute(Visit& visit, Witness& witness) {
  std::string name(name_of(witness));
  visit("witness_outlier", name);
  witness = witness_named(name);
}

template <typename Visit, typename Report>
void witness_attributes(Visit& visit, Report& witnesses) {
  estimate_attributes(visit, "gyro_share", "gyro_share_uncertainty", witnesses.gyro_share);
  estimate_attributes(visit, "images_share", "images_share_uncertainty", witnesses.images_share);
  visit("images_share_why_not", witnesses.images_why_not);
  witness_attribute(visit, witnesses.outlier);
  visit("witness_cause", witnesses.cause);
  visit("witness_remedy", witnesses.remedy);
}

template <typename Visit, typename Report>
void shaft_attributes(Visit& visit, Report& shaft) {
  visit("shaft_readings", shaft.readings);
  visit("shaft_unread", shaft.unread);
  visit("shaft_poor", shaft.poor);
  visit("shaft_used", shaft.used);
  visit("shaft_why_not", shaft.why_not);
  estimate_attributes(visit, "shaft_gyro_share", "shaft_gyro_share_uncertainty", shaft.gyro_share);
  estimate_attributes(visit, "shaft_command_share", "shaft_command_share_uncertainty", shaft.command_share);
  visit("shaft_error_deg", shaft.error_deg);
}

/// Those that a file of that version has.
template <typename Visit, typename Report>
void sync_attributes(Visit& visit, Report& sync, FormatVersion version) {
  estimate_attributes(visit, "camera_offset_s", "camera_offset_uncertainty_s", sync.camera_offset.offset_s);
  visit("camera_offset_why_not", sync.camera_offset.why_not);
  visit("camera_offset_halves", sync.camera_offset.halves);
  visit("camera_offset_applied", sync.camera_offset.applied);
  visit("gyro_scale", sync.gyro.scale.value);
  visit("gyro_scale_uncertainty", sync.gyro.scale.uncertainty);
  visit("gyro_scale_calibrated", sync.gyro.scale_calibrated);
  estimate_attributes(visit, "gyro_bias_dps", "gyro_bias_uncertainty_dps", sync.gyro.bias_dps);
  visit("gyro_bias_before_dps", sync.gyro.bias_before_dps);
  visit("gyro_bias_after_dps", sync.gyro.bias_after_dps);
  visit("gyro_noise_dps", sync.gyro.noise_dps);
  visit("gyro_zeroes_itself", sync.gyro.zeroes_itself);
  visit("gyro_bias_from_legs", sync.gyro.bias_from_legs);
  visit("servo_fitted", sync.servo.fitted);
  visit("servo_delay_s", sync.servo.delay_s);
  visit("servo_delay_uncertainty_s", sync.servo.delay_uncertainty_s);
  visit("servo_loop_hz", sync.servo.loop_hz);
  visit("servo_dead_band_deg", sync.servo.dead_band_deg);
  visit("servo_scale", sync.servo.scale.value);
  visit("servo_scale_uncertainty", sync.servo.scale.uncertainty);
  visit("servo_scale_calibrated", sync.servo.scale_calibrated);
  visit("servo_gyro_ratio", sync.servo.gyro_ratio.value);
  visit("servo_gyro_ratio_uncertainty", sync.servo.gyro_ratio.uncertainty);
  visit(version.major < 2 ? "label_residual_dps" : "gyro_residual_dps", sync.servo.residual_dps);
  if (version >= with_checked_constants) constant_attributes(visit, sync);
  if (version < with_witnesses) return;
  witness_attributes(visit, sync.witnesses);
  visit("camera_bad_pixels", sync.bad_pixels);
  visit("gyro_decay_per_s", sync.gyro.decay_per_s);
  if (version >= with_measured_shaft) shaft_attributes(visit, sync.shaft);
}

}  // namespace thermorig::session

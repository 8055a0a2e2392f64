// SPDX-License-Identifier: MIT
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "../support/same_row.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

// NaN equals NaN here: what counts is that the same comes back.

inline bool same(float a, float b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

inline bool same(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

inline bool same(const Stamp& a, const Stamp& b) {
  return a.time == b.time && a.arrival == b.arrival && same(a.uncertainty_s, b.uncertainty_s) &&
         same(a.earlier_s, b.earlier_s) && same(a.later_s, b.later_s);
}

inline bool same(const HalfExposure& a, const HalfExposure& b) {
  return a.begin == b.begin && a.end == b.end;
}

inline bool same(const std::array<float, 2>& a, const std::array<float, 2>& b) {
  return same(a[0], b[0]) && same(a[1], b[1]);
}

inline bool same(const TimedFrame& a, const TimedFrame& b) {
  return a.frame.temp_c == b.frame.temp_c && same(a.frame.sensor_temp_c, b.frame.sensor_temp_c) &&
         a.span == b.span && same(a.stamp, b.stamp) && a.fresh_even == b.fresh_even &&
         a.fresh_odd == b.fresh_odd && a.exposure_begin == b.exposure_begin &&
         a.exposure_end == b.exposure_end && a.resync_before == b.resync_before && a.stale == b.stale &&
         a.missing_before == b.missing_before && same(a.half[0], b.half[0]) && same(a.half[1], b.half[1]);
}

inline bool same(const TimedGyro& a, const TimedGyro& b) {
  const auto &x = a.reading, &y = b.reading;
  return x.rate_dps == y.rate_dps && x.counts == y.counts && x.temp_c == y.temp_c &&
         x.device_time_us == y.device_time_us && x.saturated == y.saturated && a.span == b.span &&
         same(a.stamp, b.stamp) && same(a.rate_dps, b.rate_dps) && a.lost_before == b.lost_before;
}

inline bool same(const TimedServo& a, const TimedServo& b) {
  const auto &x = a.state, &y = b.state;
  return x.mcu_us == y.mcu_us && x.angle_deg == y.angle_deg && x.rate_dps == y.rate_dps &&
         x.pulse_us == y.pulse_us && x.motion == y.motion && x.fault == y.fault && x.leg == y.leg &&
         a.span == b.span && same(a.stamp, b.stamp) && a.mcu_time_us == b.mcu_time_us &&
         a.lost_before == b.lost_before;
}

inline bool same(const TimedShaft& a, const TimedShaft& b) {
  const auto &x = a.reading, &y = b.reading;
  return x.mcu_us == y.mcu_us && same(x.angle_deg, y.angle_deg) && same(x.turn_deg, y.turn_deg) &&
         same(x.uncertainty_deg, y.uncertainty_deg) && x.status == y.status && x.gain == y.gain &&
         a.span == b.span && same(a.stamp, b.stamp) && a.mcu_time_us == b.mcu_time_us &&
         same(a.angle_deg, b.angle_deg) && a.lost_before == b.lost_before;
}

inline bool same(const TimedPong& a, const TimedPong& b) {
  return a.token == b.token && a.receive_us == b.receive_us && a.send_us == b.send_us && a.span == b.span &&
         a.arrival == b.arrival;
}

inline bool same(const LabelledSample& a, const LabelledSample& b) {
  return a.frame_index == b.frame_index && a.time == b.time && a.exposure_begin == b.exposure_begin &&
         a.exposure_end == b.exposure_end && same(a.rate_shaft_dps, b.rate_shaft_dps) &&
         same(a.rate_shaft_min_dps, b.rate_shaft_min_dps) &&
         same(a.rate_shaft_max_dps, b.rate_shaft_max_dps) &&
         same(a.angle_commanded_deg, b.angle_commanded_deg) && same(a.rate_gyro_dps, b.rate_gyro_dps) &&
         a.gyro_count == b.gyro_count && same(a.rate_shaft_uncertainty_dps, b.rate_shaft_uncertainty_dps) &&
         a.reason_bits == b.reason_bits && same(a.rate_commanded_dps, b.rate_commanded_dps) &&
         same(a.rate_shaft_half_dps, b.rate_shaft_half_dps) &&
         same(a.rate_commanded_half_dps, b.rate_commanded_half_dps) &&
         same(a.rate_commanded_uncertainty_dps, b.rate_commanded_uncertainty_dps) &&
         same(a.rate_corrected_dps, b.rate_corrected_dps) &&
         same(a.rate_corrected_half_dps, b.rate_corrected_half_dps) &&
         same(a.rate_corrected_uncertainty_dps, b.rate_corrected_uncertainty_dps) &&
         same(a.angle_measured_deg, b.angle_measured_deg) && same(a.rate_measured_dps, b.rate_measured_dps) &&
         same(a.rate_measured_half_dps, b.rate_measured_half_dps) &&
         same(a.rate_measured_uncertainty_dps, b.rate_measured_uncertainty_dps) &&
         same(a.rate_gyro_half_dps, b.rate_gyro_half_dps) && same(a.gyro_spread_dps, b.gyro_spread_dps) &&
         a.leg == b.leg && a.run == b.run && a.valid == b.valid;
}

inline bool same(const ClockKnot& a, const ClockKnot& b) {
  return a.time == b.time && a.offset_s == b.offset_s && a.skew_ppm == b.skew_ppm &&
         a.residual_us == b.residual_us;
}

inline bool same(const ClockEpoch& a, const ClockEpoch& b) {
  return a.begin == b.begin && a.reason == b.reason;
}

inline bool same(const ClockGap& a, const ClockGap& b) {
  return a.begin == b.begin && a.end == b.end && a.missing == b.missing;
}

inline bool same(const BiasKnot& a, const BiasKnot& b) {
  return a.time == b.time && a.bias_dps == b.bias_dps;
}

inline bool same(const ServoResponse::AtSpeed& a, const ServoResponse::AtSpeed& b) {
  return a.rate_dps == b.rate_dps && a.residual_dps == b.residual_dps && a.spread_dps == b.spread_dps &&
         a.frames == b.frames && same(a.reached_dps, b.reached_dps) && a.contradicts == b.contradicts;
}

inline bool same(const RawStream& a, const RawStream& b) {
  return a.bytes == b.bytes && a.chunk_end == b.chunk_end && a.time_ns == b.time_ns;
}

inline bool same(const RecordingEvent& a, const RecordingEvent& b) {
  return a.time == b.time && a.kind == b.kind && a.source == b.source && a.message == b.message;
}

inline bool same(const LegRecord& a, const LegRecord& b) {
  return a.leg == b.leg && a.step == b.step && a.rate_dps == b.rate_dps && a.begin == b.begin &&
         a.end == b.end && a.frames == b.frames && a.complete == b.complete;
}

template <typename Row>
bool same(const std::vector<Row>& a, const std::vector<Row>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same(a[i], b[i])) return false;
  return true;
}

inline bool same(const ClockReport& a, const ClockReport& b) {
  return a.method == b.method && a.rate_hz == b.rate_hz && a.skew_ppm == b.skew_ppm &&
         a.wander_ppm == b.wander_ppm && a.late_p50_us == b.late_p50_us && a.late_p95_us == b.late_p95_us &&
         a.late_max_us == b.late_max_us && a.uncertainty_us == b.uncertainty_us && a.bound_us == b.bound_us &&
         a.bound_median_us == b.bound_median_us && a.bound_wander_ppm == b.bound_wander_ppm &&
         a.needed_wander_ppm == b.needed_wander_ppm && a.latency_s == b.latency_s &&
         a.largest_constant_delay_s == b.largest_constant_delay_s &&
         a.latency_uncertainty_s == b.latency_uncertainty_s && same(a.knots, b.knots) &&
         same(a.epochs, b.epochs) && same(a.gaps, b.gaps) && a.own_time_unused == b.own_time_unused;
}

inline bool same(const GyroErrors& a, const GyroErrors& b) {
  return a.scale == b.scale && a.scale_calibrated == b.scale_calibrated && a.bias_dps == b.bias_dps &&
         a.bias_before_dps == b.bias_before_dps && a.bias_after_dps == b.bias_after_dps &&
         same(a.noise_dps, b.noise_dps) && a.decay_per_s == b.decay_per_s &&
         a.zeroes_itself == b.zeroes_itself && a.bias_from_legs == b.bias_from_legs &&
         a.scale_by_turns == b.scale_by_turns && a.scale_why_not == b.scale_why_not &&
         a.scale_contradicts == b.scale_contradicts && a.filter_delay_s == b.filter_delay_s &&
         a.filter_source == b.filter_source && a.filter_contradicts == b.filter_contradicts &&
         same(a.bias_course, b.bias_course);
}

inline bool same(const ServoResponse& a, const ServoResponse& b) {
  return a.fitted == b.fitted && a.delay_s == b.delay_s && a.delay_uncertainty_s == b.delay_uncertainty_s &&
         a.loop_hz == b.loop_hz && a.dead_band_deg == b.dead_band_deg && a.scale == b.scale &&
         a.scale_calibrated == b.scale_calibrated && a.gyro_ratio == b.gyro_ratio && a.gain == b.gain &&
         same(a.residual_dps, b.residual_dps) && same(a.speeds, b.speeds);
}

inline bool same(const CameraOffset& a, const CameraOffset& b) {
  return a.offset_s == b.offset_s && a.why_not == b.why_not && a.halves == b.halves &&
         a.applied == b.applied && a.contradicts == b.contradicts && a.row_delay_s == b.row_delay_s;
}

inline std::string difference(const SyncReport& a, const SyncReport& b) {
  std::string names;
  for (const Device device : all_devices)
    if (!same(a.clock[device], b.clock[device])) names += std::string(name_of(device)) + "-clock ";
  if (a.bad_pixels != b.bad_pixels) names += "bad-pixels ";
  if (!same(a.camera_offset, b.camera_offset)) names += "camera-offset ";
  if (!same(a.gyro, b.gyro)) names += "gyro-errors ";
  if (!same(a.servo, b.servo)) names += "servo-response ";
  return names;
}

/// What differs, by name; empty if nothing does.
inline std::string difference(const RawRecording& a, const RawRecording& b) {
  std::string names;
  for (const Device device : all_devices)
    if (!same(a.received[device], b.received[device])) names += std::string(name_of(device)) + "-bytes ";
  for (const Device device : all_devices)
    if (!same(a.sent[device], b.sent[device])) names += std::string(name_of(device)) + "-sent ";
  if (!same(a.events, b.events)) names += "events ";
  if (!same(a.legs, b.legs)) names += "legs ";
  if (!live::same_rows(a.estimates, b.estimates) || a.header.estimators != b.header.estimators)
    names += "estimates ";
  if (a.complete != b.complete || a.end_time != b.end_time) names += "end ";
  const auto &x = a.header, &y = b.header;
  if (x.uuid != y.uuid || x.environment != y.environment || x.title != y.title ||
      x.start_time_utc != y.start_time_utc || x.time_reference != y.time_reference ||
      x.simulation_seed != y.simulation_seed || x.plan_toml != y.plan_toml || x.simulated != y.simulated)
    names += "header ";
  return names;
}

inline std::string difference(const Session& a, const Session& b) {
  std::string names = difference(a.raw, b.raw);
  if (!same(a.frames, b.frames)) names += "frames ";
  if (!same(a.gyro, b.gyro)) names += "gyro ";
  if (!same(a.servo, b.servo)) names += "servo ";
  if (!same(a.shaft, b.shaft)) names += "shaft ";
  if (!same(a.pongs, b.pongs)) names += "pongs ";
  if (!same(a.samples, b.samples)) names += "samples ";
  for (const Device device : all_devices)
    if (!(a.counters[device] == b.counters[device])) names += "counters ";
  if (a.state != b.state || a.settle_s != b.settle_s || a.camera_mode != b.camera_mode ||
      a.frame_period_s != b.frame_period_s)
    names += "scalars ";
  return names + difference(a.sync, b.sync);
}

}  // namespace thermorig::session

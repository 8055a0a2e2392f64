// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "column.h"
#include "format.h"
#include "hdf5_handle.h"
#include "thermorig/core/sample.h"

namespace thermorig::session {

// The tables of what the devices said: one description for writing (rows const) and reading.
// Archive is GroupWriter or GroupReader. Normative text: docs/recording_format.md.

inline constexpr std::int64_t unknown = std::numeric_limits<std::int64_t>::min();

/// Within these the true time lies, if the latency is what it is taken for.
template <typename Archive, typename Rows>
void bound_columns(Archive& archive, Rows& rows) {
  archive.template field<float>(
      {"time_earlier", "s", "the true time is at most so much before time [s]"}, rows,
      [](auto& row) -> auto& { return row.stamp.earlier_s; });
  archive.template field<float>(
      {"time_later", "s", "the true time is at most so much after time [s]"}, rows,
      [](auto& row) -> auto& { return row.stamp.later_s; });
}

/// Members that every timed message has, besides its `time`.
template <typename Archive, typename Rows>
void stamp_columns(Archive& archive, Rows& rows) {
  archive.template field<float>(
      {"time_uncertainty", "s", "standard deviation of time [s]"}, rows,
      [](auto& row) -> auto& { return row.stamp.uncertainty_s; });
  if (archive.version() >= with_sync_report) bound_columns(archive, rows);
  archive.template column<std::int64_t>(
      {"arrival_ns", "ns", "host clock when the last byte was read [ns]"}, rows,
      [](const auto& row) { return to_ns(row.stamp.arrival); },
      [](auto& row, std::int64_t ns) { row.stamp.arrival = host_time_ns(ns); });
}

/// Where the message stands in /raw.
template <typename Archive, typename Rows>
void span_columns(Archive& archive, Rows& rows) {
  archive.template field<std::uint64_t>(
      {"byte_begin", "1", "offset of the first byte in the raw stream"}, rows,
      [](auto& row) -> auto& { return row.span.begin; });
  archive.template column<std::uint32_t>(
      {"byte_count", "1", "length in bytes in the raw stream"}, rows,
      [](const auto& row) { return row.span.size(); },
      [](auto& row, std::uint32_t count) { row.span.end = row.span.begin + count; });
}

template <typename Archive>
InnerAxis half_axis(Archive& archive) {
  return archive.inner_axis({"half", "1", "chess half: 0 even, 1 odd (row + column)"}, 2);
}

/// When each chess half that a frame shows was exposed.
template <typename Archive, typename Rows>
void half_columns(Archive& archive, Rows& frames) {
  const InnerAxis half = half_axis(archive);
  archive.time_elements(
      {"half_begin", "s", "start of each half's exposure [s]"}, half, frames,
      [](auto& row, std::size_t i) -> auto& { return row.half[i].begin; });
  archive.time_elements(
      {"half_end", "s", "end of each half's exposure [s]"}, half, frames,
      [](auto& row, std::size_t i) -> auto& { return row.half[i].end; });
  archive.template elements<float>(
      {"half_age", "s", "age of each half at time: time - half_end [s]"}, half, frames,
      [](const auto& row, std::size_t i) { return to_s(row.stamp.time - row.half[i].end); },
      [](auto&, std::size_t, float) {});
}

inline const Column temperature_column{
    "temperature", "degC", "temperature [degC]",
    "as sent: nothing repaired. If the attribute mirrored of this group is 1, reverse the columns to see "
    "the scene"};

/// The axes of an image.
template <typename Archive>
std::array<InnerAxis, 2> pixel_axes(Archive& archive) {
  return {archive.inner_axis({"row", "1", "row, in the order of the sensor"}, frame_rows),
          archive.inner_axis({"column", "1", "column, in the order of the sensor"}, frame_columns)};
}

/// What is new in a frame, and what is missing before it. The rows may be of any type with such members.
template <typename Archive, typename Rows>
void freshness_columns(Archive& archive, Rows& frames) {
  archive.template field<std::uint16_t>(
      {"fresh_even", "1", "pixels of the even chess half that differ from the frame before"}, frames,
      [](auto& row) -> auto& { return row.fresh_even; });
  archive.template field<std::uint16_t>(
      {"fresh_odd", "1", "pixels of the odd chess half that differ from the frame before"}, frames,
      [](auto& row) -> auto& { return row.fresh_odd; });
  archive.template field<std::uint16_t>(
      {"missing_before", "1", "frames that never came between the frame before and this one"}, frames,
      [](auto& row) -> auto& { return row.missing_before; });
}

template <typename Archive, typename Rows>
void camera_columns(Archive& archive, Rows& frames) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]", "end of the exposure of the newest half"}, frames,
      [](auto& row) -> auto& { return row.stamp.time; }, frames_max);
  archive.template block<float>(
      temperature_column, pixel_axes(archive), frames, [](auto& row) -> auto& { return row.frame.temp_c; });
  archive.template field<float>(
      {"sensor_temperature", "degC", "temperature of the sensor itself [degC]"}, frames,
      [](auto& row) -> auto& { return row.frame.sensor_temp_c; });
  freshness_columns(archive, frames);
  archive.time_column({"exposure_begin", "s", "start of the older half's exposure [s]"}, frames,
                      &TimedFrame::exposure_begin);
  archive.time_column({"exposure_end", "s", "end of the newest half's exposure [s]"}, frames,
                      &TimedFrame::exposure_end);
  if (archive.version() >= with_sync_report) half_columns(archive, frames);
  archive.template column<std::uint8_t>(
      {"status", "1", "state of the frame", "", flag_masks({"resync_before", "stale", "late"})}, frames,
      [](const auto& row) { return (row.resync_before ? 1 : 0) | (row.stale ? 2 : 0) | (row.late ? 4 : 0); },
      [](auto& row, std::uint8_t status) {
        row.resync_before = (status & 1U) != 0;
        row.stale = (status & 2U) != 0;
        row.late = (status & 4U) != 0;
      });
  stamp_columns(archive, frames);
  span_columns(archive, frames);
}

template <typename Archive, typename Rows>
void gyro_columns(Archive& archive, Rows& gyro) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]", "the instant of the sample"}, gyro,
      [](auto& row) -> auto& { return row.stamp.time; });
  archive.template field<float>(
      {"rate", "deg/s", "rate about the servo's axis [deg/s]", "axis and sign applied, bias not removed"},
      gyro, &TimedGyro::rate_dps);
  const std::array<InnerAxis, 1> axes{archive.inner_axis({"axis", "1", "axis: 0 x, 1 y, 2 z"}, 3)};
  archive.template block<float>(
      {"rate_xyz", "deg/s", "rate about x, y, z as sent [deg/s]"}, axes, gyro,
      [](auto& row) -> auto& { return row.reading.rate_dps; });
  archive.template block<std::int16_t>(
      {"counts", "1", "x, y, z as on the wire", "0 where the protocol has no counts"}, axes, gyro,
      [](auto& row) -> auto& { return row.reading.counts; });
  archive.template column<std::uint8_t>(
      {"status", "1", "state of the sample", "", flag_masks({"saturated", "lost_before"})}, gyro,
      [](const auto& row) { return (row.reading.saturated ? 1 : 0) | (row.lost_before ? 2 : 0); },
      [](auto& row, std::uint8_t status) {
        row.reading.saturated = (status & 1U) != 0;
        row.lost_before = (status & 2U) != 0;
      });
  archive.template column<float>(
      {"temperature", "degC", "temperature of the gyro [degC]", "NaN: not sent with this sample"}, gyro,
      [](const auto& row) { return row.reading.temp_c.value_or(std::numeric_limits<float>::quiet_NaN()); },
      [](auto& row, float value) {
        if (!std::isnan(value)) row.reading.temp_c = value;
      });
  archive.template column<std::int64_t>(
      {"device_time_us", "us", "time of the gyro's own clock [us]", "-2^63: not sent with this sample"}, gyro,
      [](const auto& row) { return row.reading.device_time_us.value_or(unknown); },
      [](auto& row, std::int64_t value) {
        if (value != unknown) row.reading.device_time_us = value;
      });
  stamp_columns(archive, gyro);
  span_columns(archive, gyro);
}

/// A stored number as the enumeration that it stands for.
template <typename Enum>
Enum checked_enum(std::uint8_t value, Enum last) {
  if (value > static_cast<std::uint8_t>(last)) throw Hdf5Failure("believe a flag");
  return static_cast<Enum>(value);
}

template <typename Archive, typename Rows>
void servo_columns(Archive& archive, Rows& servo) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]", "the instant at which the telemetry held"}, servo,
      [](auto& row) -> auto& { return row.stamp.time; });
  archive.template field<std::uint32_t>(
      {"device_ticks", "us", "servo's clock, wraps at 2^32 [us]"}, servo,
      [](auto& row) -> auto& { return row.state.mcu_us; });
  archive.template field<std::int64_t>({"device_time_us", "us", "servo's clock, unwrapped [us]"}, servo,
                                       &TimedServo::mcu_time_us);
  archive.template field<float>(
      {"angle_commanded", "deg", "commanded angle [deg]"}, servo,
      [](auto& row) -> auto& { return row.state.angle_deg; });
  archive.template field<float>(
      {"rate_commanded", "deg/s", "commanded speed [deg/s]", "after the acceleration limit"}, servo,
      [](auto& row) -> auto& { return row.state.rate_dps; });
  archive.template column<float>(
      {"pulse_width", "us", "width of the last pulse put out [us]", "0: no pulse"}, servo,
      [](const auto& row) { return row.state.pulse_us; },
      [](auto& row, float us) {
        if (!(us >= 0.0F && us <= 32768.0F)) throw Hdf5Failure("believe a pulse width");
        row.state.pulse_us = us;
      });
  archive.template column<std::uint8_t>(
      {"state", "1", "motion", "", flag_values({"disarmed", "holding", "ramping", "steady", "stopping"})},
      servo, [](const auto& row) { return row.state.motion; },
      [](auto& row, std::uint8_t value) { row.state.motion = checked_enum(value, ServoMotion::stopping); });
  archive.template column<std::uint8_t>(
      {"fault", "1", "latched fault", "",
       flag_values({"none", "watchdog", "stop_byte", "limit", "bad_frames"})},
      servo, [](const auto& row) { return row.state.fault; },
      [](auto& row, std::uint8_t value) { row.state.fault = checked_enum(value, ServoFault::bad_frames); });
  archive.template field<std::uint16_t>(
      {"leg", "1", "leg that is driven", "0: none (rest or transit); else a value of step_leg"}, servo,
      [](auto& row) -> auto& { return row.state.leg; });
  archive.template column<std::uint8_t>(
      {"status", "1", "state of the message", "", flag_masks({"lost_before"})}, servo,
      [](const auto& row) { return row.lost_before ? 1 : 0; },
      [](auto& row, std::uint8_t status) { row.lost_before = (status & 1U) != 0; });
  stamp_columns(archive, servo);
  span_columns(archive, servo);
}

/// /shaft: what a sensor on the shaft read.
template <typename Archive, typename Rows>
void shaft_columns(Archive& archive, Rows& shaft) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]", "the instant of the reading"}, shaft,
      [](auto& row) -> auto& { return row.stamp.time; });
  archive.template field<std::uint32_t>(
      {"device_ticks", "us", "clock of /servo/device_ticks [us]"}, shaft,
      [](auto& row) -> auto& { return row.reading.mcu_us; });
  archive.template field<std::int64_t>({"device_time_us", "us", "the same, unwrapped [us]"}, shaft,
                                       &TimedShaft::mcu_time_us);
  archive.template field<double>(
      {"angle_sent", "deg", "angle as sent [deg]", "the sensor's direction and zero"}, shaft,
      [](auto& row) -> auto& { return row.reading.angle_deg; });
  archive.template field<double>(
      {"turn", "deg", "after so much angle_sent begins anew [deg]", "0: the device counts turns"}, shaft,
      [](auto& row) -> auto& { return row.reading.turn_deg; });
  archive.template field<float>(
      {"angle_uncertainty", "deg", "resolution and noise of one reading [deg]", "standard deviation"}, shaft,
      [](auto& row) -> auto& { return row.reading.uncertainty_deg; });
  archive.template field<double>({"angle", "deg", "angle of the shaft [deg]",
                                  "turns counted, the profile's direction and errors taken off; NaN: none"},
                                 shaft, &TimedShaft::angle_deg);
  archive.template column<std::uint8_t>(
      {"state", "1", "what the sensor says of it", "",
       flag_values({"good", "weak", "strong", "absent", "silent"})},
      shaft, [](const auto& row) { return row.reading.status; },
      [](auto& row, std::uint8_t value) { row.reading.status = checked_enum(value, last_shaft_status); });
  archive.template field<std::uint16_t>(
      {"gain", "1", "by how much the sensor has to amplify", "in its own units; 0: not said"}, shaft,
      [](auto& row) -> auto& { return row.reading.gain; });
  archive.template column<std::uint8_t>(
      {"status", "1", "state of the message", "turns are counted anew from it on",
       flag_masks({"lost_before"})},
      shaft, [](const auto& row) { return row.lost_before ? 1 : 0; },
      [](auto& row, std::uint8_t status) { row.lost_before = (status & 1U) != 0; });
  stamp_columns(archive, shaft);
  span_columns(archive, shaft);
}

}  // namespace thermorig::session

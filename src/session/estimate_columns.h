// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "device_columns.h"
#include "thermorig/core/live_estimate.h"
#include "thermorig/core/validity.h"

namespace thermorig::session {

/// What the screen said of each frame: speeds over the window that ends with it.
template <typename Archive, typename Rows>
void estimate_rate_columns(Archive& archive, Rows& rows) {
  archive.template field<float>(
      {"rate_commanded", "deg/s", "label: mean commanded speed over the window [deg/s]", "NaN: unknown"},
      rows, [](auto& row) -> auto& { return row.rate_commanded_dps; });
  archive.template field<float>(
      {"rate_gyro", "deg/s", "gyro: mean rate over the window [deg/s]", "bias not removed; NaN: unknown"},
      rows, [](auto& row) -> auto& { return row.rate_gyro_dps; });
  archive.template field<float>(
      {"rate_thermal", "deg/s", "speed by the thermal head [deg/s]", "NaN: no estimate"}, rows,
      [](auto& row) -> auto& { return row.rate_thermal_dps; });
  archive.template field<float>(
      {"rate_fusion", "deg/s", "speed by fusion [deg/s]", "NaN: no estimate"}, rows,
      [](auto& row) -> auto& { return row.rate_fusion_dps; });
  archive.template field<float>(
      {"gain", "1", "Kg: share of the thermal head in the fusion", "NaN: no fusion"}, rows,
      [](auto& row) -> auto& { return row.gain; });
}

/// /estimates: a row a frame that a live run showed. Archive is GroupWriter or GroupReader.
template <typename Archive, typename Rows>
void estimate_columns(Archive& archive, Rows& rows) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]",
       "middle of the exposure of the frame's newest half, as it was known then"},
      rows, [](auto& row) -> auto& { return row.time; }, frames_max);
  archive.template field<std::uint32_t>(
      {"frame", "1", "index into /camera where the times agree",
       "ascending; without a camera rows go on by time, and a frame of the same index is another one"},
      rows, [](auto& row) -> auto& { return row.frame_index; });
  estimate_rate_columns(archive, rows);
  archive.template column<std::uint8_t>(
      {"counted", "1", "does the window enter the figures?", "1: all its frames lie in one valid run",
       flag_values({"apart", "counted"})},
      rows, [](const auto& row) { return row.counted ? 1 : 0; },
      [](auto& row, std::uint8_t value) { row.counted = value != 0; });
  archive.template field<std::uint32_t>(
      {"reason_bits", "1", "all reasons against the frame", "", flag_masks(reason_names)}, rows,
      [](auto& row) -> auto& { return row.reason_bits; });
  archive.template field<std::uint16_t>(
      {"leg", "1", "leg that was driven", "0: none; else a value of step_leg"}, rows,
      [](auto& row) -> auto& { return row.leg; });
  archive.template field<std::uint32_t>(
      {"run", "1", "unbroken run of valid frames of one leg", "from 1; 0: not valid"}, rows,
      [](auto& row) -> auto& { return row.run; });
  archive.time_column(
      {"exposure_begin", "s", "start of the exposure [s]"}, rows,
      [](auto& row) -> auto& { return row.exposure_begin; });
  archive.time_column(
      {"exposure_end", "s", "end of the exposure [s]"}, rows,
      [](auto& row) -> auto& { return row.exposure_end; });
  archive.template column<std::int64_t>(
      {"arrival_ns", "ns", "host clock when the chunk was read that let the estimate be made [ns]"}, rows,
      [](const auto& row) { return to_ns(row.arrival); },
      [](auto& row, std::int64_t ns) { row.arrival = host_time_ns(ns); });
}

}  // namespace thermorig::session

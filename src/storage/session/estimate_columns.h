// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "device_columns.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/validity.h"

namespace thermorig::session {

/// The estimators of a recording, and their values by "estimator.value".
struct EstimateAxes {
  struct Value {
    std::size_t estimator, value;
  };
  std::vector<std::string> estimators;
  std::vector<std::string> value_names;
  std::vector<Value> values;

  explicit EstimateAxes(const std::vector<EstimatorColumn>& columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      estimators.push_back(columns[i].name);
      for (std::size_t k = 0; k < columns[i].values.size(); ++k) {
        value_names.push_back(columns[i].name + "." + columns[i].values[k]);
        values.push_back({i, k});
      }
    }
  }
};

/// A number of each estimator: `at(estimate)` refers to it.
template <typename Stored, typename Archive, typename Rows, typename At>
void estimate_elements(Archive& archive, const Column& info, const InnerAxis& axis, Rows& rows, At at) {
  archive.template elements<Stored>(
      info, axis, rows, [at](const auto& row, std::size_t i) { return std::invoke(at, row.estimates[i]); },
      [at](auto& row, std::size_t i, Stored value) { std::invoke(at, row.estimates[i]) = value; });
}

/// One of a few words of each estimator, as its number.
template <typename Word, typename Archive, typename Rows, typename At>
void estimate_words(Archive& archive, const Column& info, const InnerAxis& axis, Rows& rows, At at) {
  archive.template elements<std::uint8_t>(
      info, axis, rows,
      [at](const auto& row, std::size_t i) {
        return static_cast<std::uint8_t>(std::invoke(at, row.estimates[i]));
      },
      [at, count = info.flags.values.size()](auto& row, std::size_t i, std::uint8_t value) {
        if (value >= count) throw Hdf5Failure("believe a state or a reason of /estimates");
        std::invoke(at, row.estimates[i]) = static_cast<Word>(value);
      });
}

/// What was said of each frame by each estimator.
template <typename Archive, typename Rows>
void estimate_columns_by_name(Archive& archive, Rows& rows, const EstimateAxes& axes) {
  const InnerAxis axis =
      archive.named_axis({"estimator", "1", "who says it, as in the table of estimators"}, axes.estimators);
  estimate_elements<float>(archive,
                           {"rate", "deg/s", "speed: mean over the window [deg/s]", "NaN: it says nothing"},
                           axis, rows, &RateEstimate::rate_dps);
  estimate_elements<float>(
      archive,
      {"rate_sigma", "deg/s", "standard deviation of rate as it is stated [deg/s]", "NaN: not stated"}, axis,
      rows, &RateEstimate::rate_sigma_dps);
  estimate_elements<double>(
      archive, {"angle", "deg", "angle since the estimator's own origin [deg]", "NaN: it says nothing"}, axis,
      rows, &RateEstimate::angle_deg);
  estimate_elements<float>(
      archive, {"angle_sigma", "deg", "standard deviation of angle as it is stated [deg]", "NaN: not stated"},
      axis, rows, &RateEstimate::angle_sigma_deg);
  estimate_words<EstimateState>(
      archive, {"state", "1", "how far it can be trusted", "", flag_values(estimate_state_names)}, axis, rows,
      &RateEstimate::state);
  estimate_words<EstimateReason>(
      archive, {"reason", "1", "why it is not good", "", flag_values(estimate_reason_names)}, axis, rows,
      &RateEstimate::reason);
  if (axes.values.empty()) return;
  const InnerAxis value =
      archive.named_axis({"value_name", "1", "estimator and name of the value"}, axes.value_names);
  // A copy: it is asked again when the chunks are made.
  const auto at = [places = axes.values](auto& row, std::size_t i) -> auto& {
    return row.estimates[places[i].estimator].values[places[i].value];
  };
  archive.template elements<float>({"value", "1", "what else it says", "NaN: not known"}, value, rows, at,
                                   [at](auto& row, std::size_t i, float number) { at(row, i) = number; });
}

/// Before format 2 three estimators stood in columns of their own.
template <typename Archive, typename Rows>
void estimate_columns_before_format_2(Archive& archive, Rows& rows) {
  const auto rate_column = [&](const char* name, std::size_t place) {
    archive.template column<float>({name, "deg/s", name}, rows, nullptr, [place](auto& row, float rate_dps) {
      row.estimates[place] = rate_only(rate_dps);
    });
  };
  rate_column("rate_gyro", 0);
  rate_column("rate_thermal", 1);
  rate_column("rate_fusion", 2);
  archive.template column<float>({"gain", "1", "gain"}, rows, nullptr,
                                 [](auto& row, float gain) { row.estimates[2].values[0] = gain; });
}

/// /estimates: a row a frame that a live run showed, without what the estimators say. Archive is GroupWriter
/// or GroupReader.
template <typename Archive, typename Rows>
void estimate_row_columns(Archive& archive, Rows& rows) {
  archive.time_axis({"time", "s", "time since time_reference [s]",
                     "middle of the exposure of the frame's newest half, as it was known then"},
                    rows, &EstimateRow::time, frames_max);
  archive.template field<std::uint32_t>(
      {"frame", "1", "index into /camera where the times agree",
       "ascending; without a camera rows go on by time, and a frame of the same index is another one"},
      rows, &EstimateRow::frame_index);
  archive.template field<float>(
      {"rate_commanded", "deg/s", "label: mean commanded speed over the window [deg/s]", "NaN: unknown"},
      rows, &EstimateRow::rate_commanded_dps);
  archive.template column<std::uint8_t>(
      {"counted", "1", "does the window enter the figures?", "1: all its frames lie in one valid run",
       flag_values({"excluded", "counted"})},
      rows, [](const auto& row) { return row.counted ? 1 : 0; },
      [](auto& row, std::uint8_t value) { row.counted = value != 0; });
  archive.template field<std::uint32_t>(
      {"reason_bits", "1", "all reasons against the frame", "", flag_masks(reason_names)}, rows,
      &EstimateRow::reason_bits);
  archive.template field<std::uint16_t>(
      {"leg", "1", "leg that was driven", "0: none; else a value of step_leg"}, rows, &EstimateRow::leg);
  archive.template field<std::uint32_t>(
      {"run", "1", "unbroken run of valid frames of one leg", "from 1; 0: not valid"}, rows,
      &EstimateRow::run);
  archive.time_column({"exposure_begin", "s", "start of the exposure [s]"}, rows,
                      &EstimateRow::exposure_begin);
  archive.time_column({"exposure_end", "s", "end of the exposure [s]"}, rows, &EstimateRow::exposure_end);
  archive.template column<std::int64_t>(
      {"arrival_ns", "ns", "host clock when the chunk was read that let the estimate be made [ns]"}, rows,
      [](const auto& row) { return to_ns(row.arrival); },
      [](auto& row, std::int64_t ns) { row.arrival = host_time_ns(ns); });
}

}  // namespace thermorig::session

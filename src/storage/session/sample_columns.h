// SPDX-License-Identifier: MIT
#pragma once

#include "device_columns.h"
#include "thermorig/core/validity.h"

namespace thermorig::session {

/// "none", then the reasons: what /samples/reason counts.
inline Flags first_reason_flags() {
  Flags flags = flag_values({"none"});
  for (std::uint32_t i = 0; i < reason_count; ++i) {
    flags.values.push_back(i + 1);
    flags.meanings.push_back(reason_names[i]);
  }
  return flags;
}

inline constexpr int no_step = 65535;

/// What came with format 1.1: the label by the pulses, and all three speeds for each half of the frame.
template <typename Archive, typename Rows>
void half_rate_columns(Archive& archive, Rows& samples) {
  archive.template field<float>(
      {"rate_commanded", "deg/s", "label: commanded mean speed over the exposure, by the pulses [deg/s]",
       "NaN: unknown"},
      samples, &LabelledSample::rate_commanded_dps);
  const std::array<InnerAxis, 1> half{half_axis(archive)};
  archive.template block<float>({"rate_shaft_half",
                                 "deg/s",
                                 "rate_shaft over each half's own exposure [deg/s]",
                                 "NaN: unknown",
                                 {},
                                 "rate_label_half"},
                                half, samples, &LabelledSample::rate_shaft_half_dps);
  archive.template block<float>({"rate_commanded_half", "deg/s",
                                 "rate_commanded over each half's own exposure [deg/s]", "NaN: unknown"},
                                half, samples, &LabelledSample::rate_commanded_half_dps);
  if (archive.version() >= with_corrected_label)
    archive.template block<float>({"rate_corrected_half", "deg/s",
                                   "rate_corrected over each half's own exposure [deg/s]", "NaN: unknown"},
                                  half, samples, &LabelledSample::rate_corrected_half_dps);
  if (archive.version() >= with_measured_shaft)
    archive.template block<float>(
        {"rate_measured_half", "deg/s", "rate_measured over each half's own exposure [deg/s]",
         "NaN: not measured"},
        half, samples, &LabelledSample::rate_measured_half_dps);
  archive.template block<float>(
      {"rate_gyro_half", "deg/s", "rate_gyro over each half's own exposure [deg/s]", "NaN: no sample"}, half,
      samples, &LabelledSample::rate_gyro_half_dps);
  archive.template field<float>({"gyro_spread", "deg/s", "gyro: standard deviation over the exposure [deg/s]",
                                 "after a running mean over one pulse period; NaN: unknown"},
                                samples, &LabelledSample::gyro_spread_dps);
}

/// What came with format 2.2: the label that this session's own gyro corrects, and what either is worth.
template <typename Archive, typename Rows>
void corrected_rate_columns(Archive& archive, Rows& samples) {
  archive.template field<float>(
      {"rate_commanded_uncertainty", "deg/s",
       "standard deviation of rate_commanded against the shaft [deg/s]", "NaN: unknown"},
      samples, &LabelledSample::rate_commanded_uncertainty_dps);
  archive.template field<float>(
      {"rate_corrected", "deg/s",
       "label: commanded speed, corrected by what the session measured of the servo [deg/s]",
       "rate_commanded where no response was fitted; NaN: unknown"},
      samples, &LabelledSample::rate_corrected_dps);
  archive.template field<float>(
      {"rate_corrected_uncertainty", "deg/s",
       "standard deviation of rate_corrected against the shaft [deg/s]", "NaN: unknown"},
      samples, &LabelledSample::rate_corrected_uncertainty_dps);
}

/// What came with format 2.5: the shaft as a sensor on it measures it.
template <typename Archive, typename Rows>
void measured_rate_columns(Archive& archive, Rows& samples) {
  archive.template field<double>({"angle_measured", "deg", "measured angle of the shaft at time [deg]",
                                  "turns counted; NaN: not measured"},
                                 samples, &LabelledSample::angle_measured_deg);
  archive.template field<float>(
      {"rate_measured", "deg/s", "label: measured mean speed of the shaft over the exposure [deg/s]",
       "NaN: not measured"},
      samples, &LabelledSample::rate_measured_dps);
  archive.template field<float>({"rate_measured_uncertainty", "deg/s",
                                 "standard deviation of rate_measured [deg/s]", "NaN: not measured"},
                                samples, &LabelledSample::rate_measured_uncertainty_dps);
}

/// /samples: one row a frame. Legs are numbered from 1 in the order of the rows of /servo/step_*. Archive is
/// GroupWriter or GroupReader.
template <typename Archive, typename Rows>
void sample_columns(Archive& archive, Rows& samples) {
  archive.time_axis(
      {"time", "s", "time since time_reference [s]", "middle of the exposure of the frame's newest half"},
      samples, &LabelledSample::time, frames_max);
  archive.template field<std::uint32_t>({"frame", "1", "index into /camera"}, samples,
                                        &LabelledSample::frame_index);
  archive.template field<float>({"rate_shaft",
                                 "deg/s",
                                 "shaft: mean speed over the exposure by the servo model [deg/s]",
                                 "NaN: unknown",
                                 {},
                                 "rate_label"},
                                samples, &LabelledSample::rate_shaft_dps);
  archive.template field<float>({"rate_shaft_min",
                                 "deg/s",
                                 "least speed of the shaft by the servo model over the exposure [deg/s]",
                                 "",
                                 {},
                                 "rate_label_min"},
                                samples, &LabelledSample::rate_shaft_min_dps);
  archive.template field<float>({"rate_shaft_max",
                                 "deg/s",
                                 "greatest speed of the shaft by the servo model over the exposure [deg/s]",
                                 "",
                                 {},
                                 "rate_label_max"},
                                samples, &LabelledSample::rate_shaft_max_dps);
  archive.template field<float>(
      {"angle_commanded", "deg", "commanded angle at time [deg]", "NaN: unknown", {}, "angle_label"}, samples,
      &LabelledSample::angle_commanded_deg);
  archive.template field<float>(
      {"rate_gyro", "deg/s", "gyro: mean rate over the exposure [deg/s]", "bias not removed; NaN: no sample"},
      samples, &LabelledSample::rate_gyro_dps);
  archive.template field<std::uint16_t>({"gyro_count", "1", "gyro samples in the mean"}, samples,
                                        &LabelledSample::gyro_count);
  archive.template field<float>({"rate_shaft_uncertainty",
                                 "deg/s",
                                 "standard deviation of rate_shaft [deg/s]",
                                 "",
                                 {},
                                 "label_uncertainty"},
                                samples, &LabelledSample::rate_shaft_uncertainty_dps);
  archive.template column<std::uint8_t>(
      {"valid", "1", "can the sample be trusted?", "1: no reason against it but warnings",
       flag_values({"invalid", "valid"})},
      samples, [](const auto& row) { return row.valid ? 1 : 0; },
      [](auto& row, std::uint8_t value) { row.valid = value != 0; });
  archive.template column<std::uint8_t>(
      {"reason", "1", "first reason against the sample", "", first_reason_flags()}, samples,
      [](const auto& row) { return row.first_reason(); }, [](auto&, std::uint8_t) {});
  archive.template field<std::uint32_t>(
      {"reason_bits", "1", "all reasons against the sample",
       "bits outside the attribute computed_mask are not computed by this version: always 0",
       flag_masks(reason_names)},
      samples, &LabelledSample::reason_bits);
  archive.template field<std::uint16_t>(
      {"leg", "1", "leg that was driven", "0: none; else a value of step_leg"}, samples,
      &LabelledSample::leg);
  archive.template column<std::uint16_t>(
      {"step", "1", "row of /servo/step_*", "65535: outside legs"}, samples,
      [](const auto& row) { return row.leg == 0 ? no_step : row.leg - 1; }, [](auto&, std::uint16_t) {});
  archive.template field<std::uint32_t>(
      {"run", "1", "unbroken run of valid frames of one leg", "from 1; 0: not valid"}, samples,
      &LabelledSample::run);
  if (archive.version() >= with_sync_report) half_rate_columns(archive, samples);
  if (archive.version() >= with_corrected_label) corrected_rate_columns(archive, samples);
  if (archive.version() >= with_measured_shaft) measured_rate_columns(archive, samples);
  archive.time_column({"exposure_begin", "s", "start of the exposure [s]"}, samples,
                      &LabelledSample::exposure_begin);
  archive.time_column({"exposure_end", "s", "end of the exposure [s]"}, samples,
                      &LabelledSample::exposure_end);
}

}  // namespace thermorig::session

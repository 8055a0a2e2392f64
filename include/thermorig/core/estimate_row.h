// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/time.h"

namespace thermorig {

/// Which network made the estimates of a live run; part of a recording's header.
struct LiveModel {
  std::string name;   // of the file, without folders; empty: no network ran
  std::string hash;   // SHA-256 of the file, hexadecimal
  int frames = 0;     // Nf
  int reduction = 0;  // Nr
  bool fusion = false;
  bool simulated = false;  // trained on data of a simulated rig
  double label_scale_dps = 200.0;
  std::string precision = "fp32";  // of its weights: fp32 or fp16
  int turned = 1;                  // 8: the mean over each window's eight turns
};

/// An estimator of a recording: what stands at its place in the rows.
struct EstimatorColumn {
  std::string name;                 // of the table of estimators, e.g. "gyro-rest"
  std::vector<std::string> values;  // names of RateEstimate::values
  bool operator==(const EstimatorColumn&) const = default;
};

inline constexpr std::size_t most_estimators = 16;  // of one run

/// Those of recordings of before format 2, which had no others: with a network its thermal head, with a gate
/// its fusion.
std::vector<EstimatorColumn> columns_before_format_2(const LiveModel& model);

/// What was known of one frame at the moment at which a live run showed it: a row of `/estimates`. Times are
/// causal; finalising knows them, and so the labels, better. Speeds are means over the window that ends with
/// this frame: its last Nf frames (without a network: the frame alone). NaN: not known.
struct EstimateRow {
  std::uint32_t frame_index = 0;  // index into the camera's frames, from 0
  HostTime time{};                // middle of the exposure of the newest half
  HostTime exposure_begin{};      // of the frame
  HostTime exposure_end{};
  HostTime arrival{};             // of the chunk that let the estimate be made
  float rate_commanded_dps = 0;   // the label
  std::uint32_t reason_bits = 0;  // of the frame
  std::uint32_t run = 0;          // of the frame: unbroken run of valid frames; 0 if not valid
  std::uint16_t leg = 0;
  bool counted = false;  // all frames of the window lie in one valid run: only these enter a figure
  std::array<RateEstimate, most_estimators> estimates{};  // one an estimator of the recording, in their order
};

}  // namespace thermorig

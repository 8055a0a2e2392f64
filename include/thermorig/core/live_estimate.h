// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

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
};

/// What was known of one frame at the moment at which a live run showed it: a row of `/estimates`. Times are
/// causal; finalising knows them, and so the labels, better. Speeds are means over the window that ends with
/// this frame: its last Nf frames (without a network: the frame alone). NaN: not known.
struct LiveEstimate {
  std::uint32_t frame_index = 0;  // index into the camera's frames, from 0
  HostTime time{};                // middle of the exposure of the newest half
  HostTime exposure_begin{};      // of the frame
  HostTime exposure_end{};
  HostTime arrival{};             // of the chunk that let the estimate be made
  float rate_commanded_dps = 0;   // the label
  float rate_gyro_dps = 0;        // bias not removed
  float rate_thermal_dps = 0;     // by the thermal head
  float rate_fusion_dps = 0;      // NaN for a thermal-only network and without gyro
  float gain = 0;                 // Kg, 0..1; NaN where there is no fusion
  std::uint32_t reason_bits = 0;  // of the frame
  std::uint32_t run = 0;          // of the frame: unbroken run of valid frames; 0 if not valid
  std::uint16_t leg = 0;
  bool counted = false;  // all frames of the window lie in one valid run: only these enter a figure
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"

namespace thermorig::labels {

/// Commanded speeds that differ by less are the same one: telemetry counts centidegrees per second.
inline constexpr double constant_dps = 0.015;

/// Standard deviation of a bias of which nothing is known.
inline constexpr double unknown_bias_dps = 20.0;

struct LabelConfig {
  double settle_s = 0.2;               // where no response was fitted: telemetry needed before the exposure
  double rate_tolerance_dps = 1.0;     // the shaft's speed may leave the commanded one by this,
  double rate_tolerance_share = 0.02;  // or by this share of it, whichever is more
  double telemetry_gap_s = 0.05;       // a longer hole in telemetry is a loss
  double bridged_silence_s = 0.0;      // of readings of the shaft that are asked for: MeasuredTrack
  double gyro_gap_share = 0.5;         // fewer than this share of the expected gyro samples is a gap
  double gyro_rate_hz = 200.0;
  double wait_s = 1.0;      // a frame waits so long for late telemetry and gyro, then goes without
  double history_s = 10.0;  // telemetry and gyro samples are kept so long
  double stop_margin_deg = 2.0;
  double travel_deg = 2160.0;  // 0 for a continuous servo: no stops

  bool by_gyro = false;            // no servo is there: the label is the gyro's
  ServoProfile servo;              // what a pulse width commands
  ServoResponse response;          // where it is fitted; else assumed_response(servo) stands in
  std::optional<GyroErrors> gyro;  // fitted; none: those of the profile, and bias from the rests so far
  GyroProfile gyro_profile;
  std::vector<ClockGap> gyro_gaps;  // in which samples never came, ascending; found by a first pass
  bool by_sensor = false;           // of the shaft, where it was read: labels are its
  double sensor_error_deg = 0.0;    // of it, by what repeats with each turn
  double sensor_latency_uncertainty_s = 0.0;
  double clock_limit_s = 0.002;        // a frame whose clock is less certain is out of sync
  double latency_uncertainty_s = 0.0;  // of the constant between the camera's clock and the servo model's
  double warm_up_k_per_min = 0.5;      // the camera's own temperature changes faster: it is warming up
  bool warm_up_invalidates = false;    // else it is a warning
};

/// What the profile says, and what a first pass over the recording found out, if there was one.
/// `merges_halves`: see latency_uncertainty_s().
LabelConfig label_config(const RigProfile& profile, const std::optional<SyncReport>& sync,
                         bool merges_halves);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::labels {

struct LabelConfig {
  double settle_s = 0.2;            // constant speed needed before the exposure, for the servo to follow
  double rate_tolerance_dps = 0.5;  // "constant": the commanded speed stays within this
  double telemetry_gap_s = 0.05;    // a longer hole in telemetry is a loss
  double gyro_gap_share = 0.5;      // fewer than this share of the expected gyro samples is a gap
  double gyro_rate_hz = 200.0;
  double wait_s = 1.0;  // a frame waits so long for late telemetry and gyro, then goes without
  double stop_margin_deg = 2.0;
  double travel_deg = 2160.0;  // 0 for a continuous servo: no stops
};

/// Merges frames, gyro samples and servo telemetry in time order and gives each frame its label: the mean
/// commanded speed over its exposure (docs/recording_format.md, "Labels"), the gyro's mean over the same
/// span, and every reason not to trust it. Frames leave in the order in which they came, each exactly once.
class Labeller {
 public:
  explicit Labeller(LabelConfig config);

  void add(const TimedFrame& frame);  // `resync_before`, freshness and exposure must be filled in
  void add(const TimedGyro& gyro);
  void add(const TimedServo& servo);

  /// Frames whose telemetry and gyro samples are all there, or which have waited too long at host time `now`.
  std::vector<LabelledSample> take(HostTime now);

  /// The stream has ended: everything that still waits.
  std::vector<LabelledSample> finish();

 private:
  struct PendingFrame;
  LabelConfig config_;
  // Filled in by the implementation.
};

}  // namespace thermorig::labels

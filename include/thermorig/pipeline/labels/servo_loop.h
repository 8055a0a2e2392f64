// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"

namespace thermorig::labels {

/// A servo's own loop: commanded value in, shaft out, scale and gain 1. Exact between changes of the command
/// but for the dead band, which holds over a step.
class ServoLoop {
 public:
  /// `loop_hz` > 0; `dead_band_deg` is of positional servos.
  ServoLoop(bool continuous, double loop_hz, double dead_band_deg);

  /// As if the command had long moved by `rate_dps` and were at `value` now; of a continuous servo the
  /// command is a rate, and `rate_dps` is not used.
  void restart(double value, double rate_dps);

  /// The command holds `value` for `duration_s`. Calls step(seconds) after each step, when angle and rate
  /// are those that many seconds after the step before.
  template <typename Step>
  void advance(double value, double duration_s, Step step) {
    if (!(duration_s > 0.0)) return;
    const double count = std::clamp(std::ceil(duration_s / longest_step_s), 1.0, most_steps);
    set_step(duration_s / count);
    for (double i = 0.0; i < count; i += 1.0) {
      take_step(value);
      step(step_s_);
    }
  }

  double angle_deg() const { return angle_deg_; }
  double rate_dps() const { return rate_dps_; }

 private:
  static constexpr double longest_step_s = 0.0025;
  static constexpr double most_steps = 40.0;  // beyond it the loop has come to rest long ago
  void set_step(double step_s);
  void take_step(double value);

  bool continuous_;
  double loop_rad_;
  double half_dead_band_deg_;
  double angle_deg_ = 0.0;
  double rate_dps_ = 0.0;
  double step_s_ = 0.0;
  double from_angle_ = 1.0, from_rate_ = 0.0;            // next offset from the command
  double rate_from_angle_ = 0.0, rate_from_rate_ = 1.0;  // next rate
};

/// No servo's loop is taken to be slower.
inline constexpr double least_loop_hz = 0.5;

/// How long after a change of the commanded speed the shaft's is within 1 % of the change: delay, one pulse
/// period, and the loop.
double settle_s(const ServoResponse& response);

/// What is assumed where nothing was fitted (live).
ServoResponse assumed_response(const ServoProfile& profile);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/pulse_train.h"

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

/// How far the shaft turns for a degree of the servo's loop, relative to its mean: gain and ripples of a
/// ServoResponse.
class ShaftSlope {
 public:
  ShaftSlope(std::vector<double> gain, std::vector<ServoResponse::Ripple> ripples, const PulseScale& scale);

  /// Gain where the servo is commanded `value`: straight between the knots, constant beyond the first and the
  /// last.
  double gain(double value) const;

  /// Gain and ripples of a positional servo at the loop's angle, which grows (`forward`) or does not.
  double at(double angle_deg, bool forward) const;

  /// What gain alone makes of the loop's angle, 0 in the middle of the travel.
  double gained_deg(double angle_deg) const;

 private:
  double place(double value) const;
  double knots_turned(double place) const;

  PulseScale scale_;
  std::vector<double> gain_;
  std::vector<double> turned_;  // from the first knot to each, in distances between knots
  bool is_even_ = false;        // the same everywhere: as before a fit
  double middle_ = 0.0;         // the same to the middle of the travel
  std::vector<ServoResponse::Ripple> ripples_;
};

/// No servo's loop is taken to be slower.
inline constexpr double least_loop_hz = 0.5;

/// How long after a change of the commanded speed the shaft's is within 1 % of the change: delay, one pulse
/// period, and the loop.
double settle_s(const ServoResponse& response);

/// What is assumed where nothing was fitted (live).
ServoResponse assumed_response(const ServoProfile& profile);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

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

}  // namespace thermorig::labels

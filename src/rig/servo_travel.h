// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/profile.h"
#include "thermorig/rig/plan.h"

namespace thermorig::rig {

/// The angle that a servo has to drive legs in, to both sides of its middle. Infinite for a continuous servo
/// without a cable.
class ServoTravel {
 public:
  explicit ServoTravel(const ServoProfile& servo);

  double limit_deg() const { return limit_deg_; }  // from the middle to either end

  /// A leg of so many frames is longer than from end to end: it must turn back.
  bool is_too_short_for(double rate_dps, double frames, double frame_rate_hz) const;

  /// What such a leg covers, at most from end to end.
  double way_deg(double rate_dps, double frames, double frame_rate_hz) const;

  /// Where a leg begins that lies even about the middle.
  static double start_deg(double rate_dps, double way_deg) { return -sign_of(rate_dps) * way_deg / 2.0; }

  /// How far from the middle, in its direction, a leg ends that begins here: to be held against the limit.
  static double end_deg(double rate_dps, double way_deg, double from_deg) {
    return sign_of(rate_dps) * from_deg + way_deg;
  }

  /// Camera frames at this speed before the servo must brake for its end, at most so many.
  int frames_left(double rate_dps, double from_deg, double frame_rate_hz, int most) const;

 private:
  double acceleration_dps2_;
  double limit_deg_;
};

}  // namespace thermorig::rig

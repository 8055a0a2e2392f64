// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "thermorig/core/profile.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

/// The angle that a servo has to drive legs in, to both sides of its middle. Infinite for a continuous servo
/// without a cable.
class ServoTravel {
 public:
  explicit ServoTravel(const ServoProfile& servo)
      : acceleration_dps2_(servo.acceleration_dps2), stroke_deg_(stroke_deg(servo)) {}

  /// A leg of so many frames is longer than from end to end: it must turn back.
  bool is_too_short_for(double rate_dps, double frames, double frame_rate_hz) const {
    return leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_) > stroke_deg_;
  }

  /// What such a leg covers, at most from end to end.
  double way_deg(double rate_dps, double frames, double frame_rate_hz) const {
    return std::min(leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_), stroke_deg_);
  }

  /// Where a leg begins that lies even about the middle.
  static double start_deg(double rate_dps, double way_deg) { return -sign_of(rate_dps) * way_deg / 2.0; }

  /// Does a leg that begins here end before the end of the travel, or so little beyond it?
  bool has_room(double rate_dps, double way_deg, double from_deg, double beyond_deg = 0.0) const {
    return sign_of(rate_dps) * from_deg + way_deg <= stroke_deg_ / 2.0 + beyond_deg;
  }

  /// Camera frames at this speed before the servo must brake for its end, at most so many.
  int frames_left(double rate_dps, double from_deg, double frame_rate_hz, int most) const {
    constexpr double command_delay_s = 0.25;  // from here to the servo's next command
    const double speed_dps = std::abs(rate_dps);
    const double room_deg =
        stroke_deg_ / 2.0 - sign_of(rate_dps) * from_deg - speed_dps * speed_dps / (2.0 * acceleration_dps2_);
    const double frames = (room_deg / speed_dps - command_delay_s) * frame_rate_hz;
    return static_cast<int>(std::clamp(frames - 1.0, 0.0, static_cast<double>(most)));
  }

 private:
  double acceleration_dps2_;
  double stroke_deg_;  // from end to end
};

}  // namespace thermorig::rig

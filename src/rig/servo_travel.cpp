// SPDX-License-Identifier: MIT
#include "servo_travel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::rig {

ServoTravel::ServoTravel(const ServoProfile& servo)
    : acceleration_dps2_(servo.acceleration_dps2),
      limit_deg_(angle_limit_deg(servo).value_or(std::numeric_limits<double>::infinity())) {}

bool ServoTravel::is_too_short_for(double rate_dps, double frames, double frame_rate_hz) const {
  return leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_) > 2.0 * limit_deg_;
}

double ServoTravel::way_deg(double rate_dps, double frames, double frame_rate_hz) const {
  return std::min(leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_), 2.0 * limit_deg_);
}

int ServoTravel::frames_left(double rate_dps, double from_deg, double frame_rate_hz, int most) const {
  constexpr double command_delay_s = 0.25;  // from here to the servo's next command
  const double speed_dps = std::abs(rate_dps);
  const double room_deg =
      limit_deg_ - sign_of(rate_dps) * from_deg - speed_dps * speed_dps / (2.0 * acceleration_dps2_);
  const double frames = (room_deg / speed_dps - command_delay_s) * frame_rate_hz;
  return static_cast<int>(std::clamp(frames - 1.0, 0.0, static_cast<double>(most)));
}

}  // namespace thermorig::rig

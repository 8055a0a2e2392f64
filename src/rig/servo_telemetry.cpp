// SPDX-License-Identifier: MIT
#include "servo_telemetry.h"

#include <algorithm>

#include "thermorig/rig/plan.h"

namespace thermorig::rig {

void ServoTelemetry::take(const TimedServo& servo) {
  last_ = servo;
  if (servo.state.motion != ServoMotion::disarmed) driven_angle_deg_ = servo.state.angle_deg;
}

bool ServoTelemetry::is_recent(HostTime now) const {
  return last_ && now - last_->stamp.time <= std::chrono::milliseconds(100);
}

double ServoTelemetry::arm_angle_deg(const ServoProfile& servo) const {
  const double limit_deg = angle_limit_deg(servo).value_or(0.0);
  return std::clamp(driven_angle_deg_.value_or(angle_deg()), -limit_deg, limit_deg);
}

}  // namespace thermorig::rig

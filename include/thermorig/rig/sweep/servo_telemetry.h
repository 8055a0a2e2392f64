// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <optional>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

/// What the servo said last, and what that proves. Before it has said anything: nothing.
class ServoTelemetry {
 public:
  void take(const TimedServo& servo) {
    last_ = servo;
    if (servo.state.motion != ServoMotion::disarmed) driven_angle_deg_ = servo.state.angle_deg;
  }

  /// The servo was armed at this time: what it reported before then is no news.
  void armed(HostTime time) { armed_since_ = time; }

  bool has_come() const { return last_.has_value(); }
  bool is_newer_than_arming() const { return last_ && last_->stamp.time > armed_since_; }
  bool arrived_after(HostTime time) const { return last_ && last_->stamp.arrival > time; }
  /// It tells of the last 100 ms: less than the servo's watchdog waits for.
  bool is_recent(HostTime now) const {
    return last_ && now - last_->stamp.time <= std::chrono::milliseconds(100);
  }

  bool at_rest() const { return last_ && is_at_rest(last_->state); }
  bool is_disarmed() const { return last_ && last_->state.motion == ServoMotion::disarmed; }
  ServoFault fault() const { return last_ ? last_->state.fault : ServoFault::none; }
  double angle_deg() const { return last_ ? last_->state.angle_deg : 0.0; }
  double rate_dps() const { return last_ ? last_->state.rate_dps : 0.0; }

  /// Where the shaft is, as far as anybody knows, within the servo's limits: armed there, it does not move.
  double arm_angle_deg(const ServoProfile& servo) const {
    const double limit_deg = angle_limit_deg(servo).value_or(0.0);
    return std::clamp(driven_angle_deg_.value_or(angle_deg()), -limit_deg, limit_deg);
  }

 private:
  std::optional<TimedServo> last_;
  std::optional<double> driven_angle_deg_;  // commanded last while it was armed
  HostTime armed_since_{};
};

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/rig/sweep/servo_driver.h"
#include "thermorig/rig/sweep/sweep.h"

namespace thermorig::rig {

/// "the servo's watchdog tripped".
std::string fault_text(ServoFault fault);

/// What interrupted a sweep, and its way back to the phase that it was in: at rest, armed again, on.
class SweepRecovery {
 public:
  explicit SweepRecovery(ServoDriver& commander) : commander_(commander) {}

  /// The servo failed. Throws Error(device_lost) where it has failed too often.
  void count_failure(const std::string& what, ServoFault fault);
  /// It is to come to rest, and to be armed again; `interrupted`: what the sweep was at.
  void begin_after_failure(SweepPhase interrupted);

  /// A device went: the servo is to rest until it is back. Throws Error(device_lost) where devices went too
  /// often; `why` it went is part of it.
  void device_went(SweepPhase interrupted, const Error& why);
  /// `faulty`: the servo, since then.
  void device_is_back(bool faulty);

  /// A leg was driven to its end: what failed before it does not count any more.
  void leg_was_driven() { failures_ = interruptions_ = 0; }

  /// Throws Error(device_lost) if it has taken too long.
  void check_patience(double passed_s) const;
  /// Arms the servo once it has rested for long enough. Says when it is armed.
  bool is_armed_again(double passed_s, bool at_rest, double arm_angle_deg);
  /// Ends it. What ought to be known of it, mostly nothing.
  std::optional<std::string> finish(double passed_s);

  SweepPhase interrupted() const { return interrupted_; }
  const std::vector<SweepTrouble>& troubles() const { return troubles_; }

 private:
  void note_phase(SweepPhase interrupted);
  double rest_s() const;

  ServoDriver& commander_;
  SweepPhase interrupted_ = SweepPhase::leg;
  int failures_ = 0;       // of this step, in a row
  int interruptions_ = 0;  // by devices that went, since a leg was driven to its end
  double shortest_rest_s_ = 0.0;
  bool arm_sent_ = false;
  std::vector<SweepTrouble> troubles_;
};

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

/// Brings the servo to rest and disarms it: with a halt at the end of a plan, with the stop byte on request.
class ServoStop {
 public:
  explicit ServoStop(ServoDriver& commander) : commander_(commander) {}

  void halt() { commander_.halt(); }
  /// Is it at rest and disarmed? To be asked at each tick after halt(). Throws Error(device_lost) where that
  /// takes too long.
  bool has_halted(HostDuration waited, const ServoTelemetry& telemetry);

  /// Stop byte, then halt. False: the servo was never greeted, nothing moves.
  bool request();
  enum class Request : std::uint8_t { under_way, confirmed, unconfirmed };
  /// To be asked at each tick after request(), which was at `requested`.
  Request requested_at(HostTime requested, HostTime now, const ServoTelemetry& telemetry);

  /// It is as good as off: what it reports is no fault.
  bool is_disarming() const { return disarm_sent_; }

 private:
  void disarm();

  ServoDriver& commander_;
  int tries_ = 0;
  bool disarm_sent_ = false;
};

}  // namespace thermorig::rig

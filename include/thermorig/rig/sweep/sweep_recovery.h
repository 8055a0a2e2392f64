// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/servo_commander.h"
#include "thermorig/rig/sweep/servo_telemetry.h"
#include "thermorig/rig/sweep/sweep.h"

namespace thermorig::rig {

/// "the servo's watchdog tripped".
std::string fault_text(ServoFault fault);

/// What interrupted a sweep, and its way back to the phase that it was in: at rest, armed again, on.
class SweepRecovery {
 public:
  explicit SweepRecovery(ServoCommander& commander) : commander_(commander) {}

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

  ServoCommander& commander_;
  SweepPhase interrupted_ = SweepPhase::leg;
  int failures_ = 0;       // of this step, in a row
  int interruptions_ = 0;  // by devices that went, since a leg was driven to its end
  double shortest_rest_s_ = 0.0;
  bool arm_sent_ = false;
  std::vector<SweepTrouble> troubles_;
};

}  // namespace thermorig::rig

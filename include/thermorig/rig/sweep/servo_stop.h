// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/rig/sweep/servo_commander.h"
#include "thermorig/rig/sweep/servo_telemetry.h"

namespace thermorig::rig {

/// Brings the servo to rest and disarms it: with a halt at the end of a plan, with the stop byte on request.
class ServoStop {
 public:
  explicit ServoStop(ServoCommander& commander) : commander_(commander) {}

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

  ServoCommander& commander_;
  int tries_ = 0;
  bool disarm_sent_ = false;
};

}  // namespace thermorig::rig

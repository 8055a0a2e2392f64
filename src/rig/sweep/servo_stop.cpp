// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/servo_stop.h"

#include "thermorig/core/error.h"

namespace thermorig::rig {

namespace {

constexpr double halt_patience_s = 5.0;
constexpr int stop_tries = 3;  // of the raw byte, one each 50 ms
constexpr auto stop_try_gap = std::chrono::milliseconds(50);
constexpr double stop_patience_s = 1.0;

}  // namespace

void ServoStop::disarm() {
  commander_.disarm();
  disarm_sent_ = true;
}

bool ServoStop::has_halted(HostDuration waited, const ServoTelemetry& telemetry) {
  if (commander_.idle() && disarm_sent_ && telemetry.is_disarmed()) return true;
  if (commander_.idle() && !disarm_sent_ && telemetry.at_rest())
    disarm();
  else if (to_s(waited) > halt_patience_s)
    throw Error(ExitCode::device_lost, "the servo does not come to rest", "servo",
                "switch its supply off, then look at it");
  return false;
}

bool ServoStop::request() {
  const bool is_greeted = commander_.greeted();
  commander_.stop();
  tries_ = 1;
  disarm_sent_ = false;
  if (is_greeted) commander_.halt();
  return is_greeted;
}

ServoStop::Request ServoStop::requested_at(HostTime requested, HostTime now,
                                           const ServoTelemetry& telemetry) {
  const HostDuration waited = now - requested;
  const bool heard = telemetry.arrived_after(requested);
  const bool stopped = heard && telemetry.at_rest();
  if (disarm_sent_ && commander_.idle() && heard && telemetry.is_disarmed()) return Request::confirmed;
  if (stopped && commander_.idle() && !disarm_sent_) {
    disarm();
  } else if (to_s(waited) > stop_patience_s) {
    return Request::unconfirmed;
  } else if (!stopped && tries_ < stop_tries && waited >= tries_ * stop_try_gap) {
    commander_.stop();
    ++tries_;
  }
  return Request::under_way;
}

}  // namespace thermorig::rig

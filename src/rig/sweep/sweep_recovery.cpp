// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/sweep_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/sensors/wire/reset_cause.h"

namespace thermorig::rig {

namespace {

constexpr int failures_allowed = 5;            // of one leg in a row
constexpr double first_recovery_rest_s = 0.5;  // before the servo is armed again; twice as long each time
constexpr double rearm_patience_s = 5.0;
constexpr int interruptions_allowed = 5;      // of one leg by devices that go and come
constexpr double rest_after_absence_s = 2.0;  // for the clock of the device that is back

constexpr const char* supply_advice =
    "give the servo a supply of its own, with its ground joined to the board's and 470 uF or more near the "
    "servo";
constexpr const char* fault_advice = "look at cable, supply and travel of the servo";
constexpr const char* record_again = "; then record again";

/// Did the board's supply break down, so long ago at most when it was greeted?
bool broke_down(const ServoDriver& commander, double within_s) {
  const auto& welcome = commander.welcome();
  return welcome && wire::was_brown_out(welcome->reset_cause) && 1e-6 * welcome->uptime_us < within_s;
}

std::string advice_for(ServoFault fault) {
  if (fault == ServoFault::watchdog)
    return "this computer was too busy to refresh it in time (end other programs), or its cable is bad";
  return fault_advice;
}

}  // namespace

std::string fault_text(ServoFault fault) {
  switch (fault) {
    case ServoFault::watchdog:
      return "the servo's watchdog tripped";
    case ServoFault::stop_byte:
      return "the servo was stopped by a stop byte";
    case ServoFault::limit:
      return "the servo reached the end of its travel";
    case ServoFault::bad_frames:
      return "the servo received damaged commands";
    case ServoFault::none:
      break;
  }
  return "the servo stopped";
}

void SweepRecovery::count_failure(const std::string& what, ServoFault fault) {
  const std::string advice = broke_down(commander_, rearm_patience_s) ? supply_advice : advice_for(fault);
  const auto known = std::find_if(troubles_.begin(), troubles_.end(),
                                  [&](const SweepTrouble& trouble) { return trouble.what == what; });
  if (known == troubles_.end())
    troubles_.push_back({what, advice, 1});
  else
    ++known->count;
  if (++failures_ > failures_allowed)
    throw Error(ExitCode::device_lost, fmt::format("{}; {} attempts in a row failed", what, failures_),
                "servo", advice + record_again);
}

void SweepRecovery::note_phase(SweepPhase interrupted) {
  if (interrupted != SweepPhase::recovering) interrupted_ = interrupted;
  commander_.clear();
}

void SweepRecovery::begin_after_failure(SweepPhase interrupted) {
  note_phase(interrupted);
  arm_sent_ = false;
  if (commander_.was_reset()) commander_.greet();
}

void SweepRecovery::device_went(SweepPhase interrupted, const Error& why) {
  note_phase(interrupted);
  commander_.halt();
  if (++interruptions_ > interruptions_allowed)
    throw Error(ExitCode::device_lost,
                fmt::format("{}; devices failed {} times before a leg was finished", why.what_happened(),
                            interruptions_),
                why.where(), why.advice() + "; look for a loose plug or a weak USB supply");
}

void SweepRecovery::device_is_back(bool faulty) {
  failures_ = 0;
  shortest_rest_s_ = rest_after_absence_s;
  if (commander_.was_reset()) commander_.greet();
  arm_sent_ = commander_.armed() && !commander_.refusal() && !faulty;
}

// What disturbed it may last: a host that is busy for seconds must not use up every attempt.
double SweepRecovery::rest_s() const {
  return std::max(shortest_rest_s_, std::ldexp(first_recovery_rest_s, failures_ - 1));
}

void SweepRecovery::check_patience(double passed_s) const {
  if (passed_s > rest_s() + rearm_patience_s)
    throw Error(ExitCode::device_lost, "the servo cannot be armed again after a fault", "servo",
                std::string(fault_advice) + record_again);
}

bool SweepRecovery::is_armed_again(double passed_s, bool at_rest, double arm_angle_deg) {
  if (!commander_.idle() || !at_rest || passed_s < rest_s()) return false;
  if (arm_sent_ && commander_.armed() && !commander_.refusal()) return true;
  commander_.clear();
  commander_.arm(arm_angle_deg);
  arm_sent_ = true;
  return false;
}

std::optional<std::string> SweepRecovery::finish(double passed_s) {
  shortest_rest_s_ = 0.0;
  if (!broke_down(commander_, passed_s + first_recovery_rest_s)) return std::nullopt;
  return fmt::format("the supply of the servo's board broke down (brown-out), which reset it: {}",
                     supply_advice);
}

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

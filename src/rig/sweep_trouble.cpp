// SPDX-License-Identifier: MIT
// What ends a sweep early or interrupts it: faults, resets, a request to stop.
#include <fmt/format.h>

#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep.h"

namespace thermorig::rig {

namespace {

constexpr int failures_allowed = 5;            // of one leg in a row
constexpr double first_recovery_rest_s = 0.5;  // before the servo is armed again; twice as long each time
constexpr double rearm_patience_s = 5.0;
constexpr int stop_tries = 3;  // of the raw byte, one each 50 ms
constexpr auto stop_try_gap = std::chrono::milliseconds(50);
constexpr double stop_patience_s = 1.0;

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

std::string advice_for(ServoFault fault) {
  if (fault == ServoFault::watchdog)
    return "this computer was too busy to refresh it in time (end other programs), or its cable is bad; then "
           "record again";
  return "look at cable, supply and travel of the servo, then record again";
}

}  // namespace

// ---- trouble ------------------------------------------------------------------------------------------

bool SweepWalker::drives() const {
  return phase_ == SweepPhase::opening_rest || phase_ == SweepPhase::transit || phase_ == SweepPhase::leg ||
         phase_ == SweepPhase::closing_rest || phase_ == SweepPhase::halting;
}

bool SweepWalker::watch_for_trouble(HostTime now) {
  if (!drives() || !last_telemetry_ || disarm_sent_) return false;
  if (commander_.was_reset()) {
    trouble(now, "the servo's board was reset");
    return true;
  }
  const bool fresh = last_telemetry_->stamp.time > armed_since_;
  const ServoFault fault = last_telemetry_->state.fault;
  if (!commander_.refusal() && (!fresh || fault == ServoFault::none)) return false;
  trouble(now, fault_text(fault), fault);
  return true;
}

void SweepWalker::trouble(HostTime now, const std::string& what, ServoFault fault) {
  event(now, EventKind::servo_fault, what);
  settle_left_leg(now);
  if (phase_ == SweepPhase::leg) write_down(leg_, now);
  if (++failures_ > failures_allowed)
    throw Error(ExitCode::device_lost, fmt::format("{}; {} attempts in a row failed", what, failures_),
                "servo", advice_for(fault));
  if (phase_ == SweepPhase::leg && leg_.is_whole())
    finish_step(now);
  else if (phase_ == SweepPhase::leg || phase_ == SweepPhase::transit)
    note_repeat(to_drive_.front().index, now);
  if (phase_ != SweepPhase::recovering) resume_ = phase_;
  commander_.clear();
  rearm_sent_ = false;
  if (commander_.was_reset()) commander_.greet();
  enter(SweepPhase::recovering, now);
}

// What disturbed it may last: a host that is busy for seconds must not use up every attempt.
double SweepWalker::recovery_rest_s() const {
  return std::ldexp(first_recovery_rest_s, failures_ - 1);
}

void SweepWalker::tick_recovering(HostTime now) {
  const double passed_s = to_s(now - phase_begin_);
  if (passed_s > recovery_rest_s() + rearm_patience_s)
    throw Error(ExitCode::device_lost, "the servo cannot be armed again after a fault", "servo",
                advice_for(ServoFault::none));
  if (commander_.was_reset()) return trouble(now, "the servo's board was reset");
  if (!commander_.idle() || !servo_at_rest()) return;
  if (rearm_sent_ && commander_.armed() && !commander_.refusal()) return resume(now);
  if (passed_s < recovery_rest_s()) return;
  commander_.clear();
  commander_.arm(arm_angle_deg());
  rearm_sent_ = true;
}

void SweepWalker::resume(HostTime now) {
  armed_since_ = commander_.last_ack();
  if (resume_ == SweepPhase::leg || resume_ == SweepPhase::transit) return next_leg(now);
  const bool before_legs = resume_ == SweepPhase::greeting || resume_ == SweepPhase::opening_rest;
  enter(before_legs ? SweepPhase::opening_rest : SweepPhase::closing_rest, now);
}

// ---- stopping on request ------------------------------------------------------------------------------

void SweepWalker::request_stop(HostTime now) {
  if (phase_ == SweepPhase::stopping || phase_ == SweepPhase::done) return;
  if (phase_ == SweepPhase::leg) write_down(leg_, now);
  const bool nothing_moves = !commander_.greeted();
  commander_.stop();
  stop_tries_ = 1;
  disarm_sent_ = false;
  enter(nothing_moves ? SweepPhase::done : SweepPhase::stopping, now);
  if (!nothing_moves) commander_.halt();
}

void SweepWalker::tick_stopping(HostTime now) {
  const double waited_s = to_s(now - phase_begin_);
  const bool heard = last_telemetry_ && last_telemetry_->stamp.arrival > phase_begin_;
  const bool stopped = heard && servo_at_rest();
  if (disarm_sent_ && commander_.idle() && heard && servo_is_disarmed()) {
    at_rest_ = true;
    return enter(SweepPhase::done, now);
  }
  if (stopped && commander_.idle() && !disarm_sent_) {
    commander_.disarm();
    disarm_sent_ = true;
  } else if (waited_s > stop_patience_s) {
    event(now, EventKind::warning, "the stop was not confirmed; the servo's own watchdog stops it");
    enter(SweepPhase::done, now);
  } else if (!stopped && stop_tries_ < stop_tries && now - phase_begin_ >= stop_tries_ * stop_try_gap) {
    commander_.stop();
    ++stop_tries_;
  }
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
// What ends a sweep early or interrupts it: faults, resets, a request to stop.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep.h"
#include "thermorig/wire/reset_cause.h"

namespace thermorig::rig {

namespace {

constexpr int failures_allowed = 5;            // of one leg in a row
constexpr double first_recovery_rest_s = 0.5;  // before the servo is armed again; twice as long each time
constexpr double rearm_patience_s = 5.0;
constexpr int interruptions_allowed = 5;      // of one leg by devices that go and come
constexpr double rest_after_absence_s = 2.0;  // for the clock of the device that is back
constexpr int stop_tries = 3;                 // of the raw byte, one each 50 ms
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

constexpr const char* supply_advice =
    "give the servo a supply of its own, with its ground joined to the board's and 470 uF or more near the "
    "servo";

constexpr const char* record_again = "; then record again";

/// Did the board's supply break down, so long ago at most when it was greeted?
bool broke_down(const ServoCommander& commander, double within_s) {
  const auto& welcome = commander.welcome();
  return welcome && wire::was_brown_out(welcome->reset_cause) && 1e-6 * welcome->uptime_us < within_s;
}

std::string advice_for(ServoFault fault) {
  if (fault == ServoFault::watchdog)
    return "this computer was too busy to refresh it in time (end other programs), or its cable is bad";
  return "look at cable, supply and travel of the servo";
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
  const std::string advice = broke_down(commander_, rearm_patience_s) ? supply_advice : advice_for(fault);
  count_trouble(what, advice);
  if (phase_ == SweepPhase::leg) leg_.broke_off();
  write_down_cut_leg(now);
  if (++failures_ > failures_allowed)
    throw Error(ExitCode::device_lost, fmt::format("{}; {} attempts in a row failed", what, failures_),
                "servo", advice + record_again);
  repeat_cut_leg(now);
  if (phase_ != SweepPhase::recovering) resume_ = phase_;
  commander_.clear();
  rearm_sent_ = false;
  if (commander_.was_reset()) commander_.greet();
  enter(SweepPhase::recovering, now);
}

void SweepWalker::count_trouble(const std::string& what, const std::string& advice) {
  const auto known = std::find_if(troubles_.begin(), troubles_.end(),
                                  [&](const SweepTrouble& trouble) { return trouble.what == what; });
  if (known == troubles_.end())
    troubles_.push_back({what, advice, 1});
  else
    ++known->count;
}

void SweepWalker::write_down_cut_leg(HostTime now) {
  settle_left_leg(now);
  if (phase_ == SweepPhase::leg) write_down(leg_, now);
}

void SweepWalker::repeat_cut_leg(HostTime now) {
  if (phase_ == SweepPhase::leg && leg_.is_whole())
    finish_step(now);
  else if (phase_ == SweepPhase::leg || phase_ == SweepPhase::transit)
    note_repeat(to_drive_.front().index, now);
}

// ---- devices that go and come back ----------------------------------------------------------------------

void SweepWalker::suspend(HostTime now, const Error& why) {
  if (!drives() && phase_ != SweepPhase::greeting && phase_ != SweepPhase::recovering) return;
  if (phase_ == SweepPhase::halting) return;  // nothing more is asked of any device but the servo
  write_down_cut_leg(now);
  repeat_cut_leg(now);
  if (phase_ != SweepPhase::recovering) resume_ = phase_;
  commander_.clear();
  commander_.halt();
  enter(SweepPhase::awaiting, now);
  if (++interruptions_ > interruptions_allowed)
    throw Error(ExitCode::device_lost,
                fmt::format("{}; devices went {} times without a leg being finished between",
                            why.what_happened(), interruptions_),
                why.where(), why.advice() + "; look for a loose plug or a weak USB supply");
}

void SweepWalker::go_on(HostTime now) {
  if (phase_ != SweepPhase::awaiting) return;
  failures_ = 0;
  shortest_rest_s_ = rest_after_absence_s;
  if (commander_.was_reset()) commander_.greet();
  rearm_sent_ = commander_.armed() && !commander_.refusal() && !is_faulty();
  enter(SweepPhase::recovering, now);
}

bool SweepWalker::is_faulty() const {
  return last_telemetry_ && last_telemetry_->state.fault != ServoFault::none;
}

// What disturbed it may last: a host that is busy for seconds must not use up every attempt.
double SweepWalker::recovery_rest_s() const {
  return std::max(shortest_rest_s_, std::ldexp(first_recovery_rest_s, failures_ - 1));
}

void SweepWalker::tick_recovering(HostTime now) {
  const double passed_s = to_s(now - phase_begin_);
  if (passed_s > recovery_rest_s() + rearm_patience_s)
    throw Error(ExitCode::device_lost, "the servo cannot be armed again after a fault", "servo",
                advice_for(ServoFault::none) + record_again);
  if (commander_.was_reset()) return trouble(now, "the servo's board was reset");
  if (!commander_.idle() || !servo_at_rest()) return;
  if (passed_s < recovery_rest_s()) return;
  if (rearm_sent_ && commander_.armed() && !commander_.refusal()) return resume(now);
  commander_.clear();
  commander_.arm(arm_angle_deg());
  rearm_sent_ = true;
}

void SweepWalker::resume(HostTime now) {
  if (broke_down(commander_, to_s(now - phase_begin_) + first_recovery_rest_s))
    event(now, EventKind::warning,
          fmt::format("the supply of the servo's board broke down (brown-out), which reset it: {}",
                      supply_advice));
  shortest_rest_s_ = 0.0;
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

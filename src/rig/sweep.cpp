// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::rig {

namespace {

constexpr int failures_allowed = 5;         // of one leg in a row
constexpr std::size_t gaps_kept = 15;       // frame intervals from which the rate is taken
constexpr double duration_slack = 1.5;      // a leg may take so much longer than expected ...
constexpr double duration_extra_s = 2.0;    // ... and so much more, before its RUN ends
constexpr double renew_before_s = 1.0;      // a RUN that would end so soon is renewed
constexpr double last_frame_periods = 2.0;  // a leg's last frame is awaited for so long
constexpr double transit_tolerance_deg = 0.05;
constexpr double rearm_patience_s = 5.0;
constexpr double halt_patience_s = 5.0;
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

}  // namespace

std::string name_of(SweepPhase phase) {
  constexpr const char* names[] = {"waiting",    "greeting",     "opening rest", "transit",  "leg",
                                   "recovering", "closing rest", "halting",      "stopping", "done"};
  return names[static_cast<std::size_t>(phase)];
}

SweepWalker::SweepWalker(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz,
                         ServoCommander& commander)
    : plan_(plan), servo_(servo), nominal_frame_rate_hz_(nominal_frame_rate_hz), commander_(commander) {}

// ---- what comes in ------------------------------------------------------------------------------------

void SweepWalker::frame(const TimedFrame& frame) {
  if (last_frame_ && frame.stamp.time > *last_frame_) {
    frame_gaps_s_.push_back(to_s(frame.stamp.time - *last_frame_));
    if (frame_gaps_s_.size() > gaps_kept) frame_gaps_s_.erase(frame_gaps_s_.begin());
  }
  last_frame_ = frame.stamp.time;
  // A frame belongs to the leg in which the middle of its newest half was exposed, as its label says.
  const HostTime middle = frame.exposure_end - (frame.exposure_end - frame.exposure_begin) / 4;
  if (left_leg_ && middle <= left_leg_->left) {
    ++left_leg_->record.frames;
    left_leg_->record.end = frame.stamp.arrival;
    write_down_left_leg(frame.stamp.arrival);
  } else if (phase_ == SweepPhase::leg && leg_.first_seen && middle >= *leg_.first_seen) {
    ++leg_.record.frames;
    leg_.record.end = frame.stamp.arrival;
    leg_.last_middle = middle;
  }
}

void SweepWalker::telemetry(const TimedServo& servo) {
  last_telemetry_ = servo;
  if (servo.state.motion != ServoMotion::disarmed) driven_angle_deg_ = servo.state.angle_deg;
  if (phase_ == SweepPhase::leg && servo.state.leg == leg_.number && !leg_.first_seen)
    leg_.first_seen = servo.stamp.time;
}

// ---- phases -------------------------------------------------------------------------------------------

void SweepWalker::enter(SweepPhase phase, HostTime now) {
  phase_ = phase;
  phase_begin_ = now;
}

void SweepWalker::greet() {
  commander_.greet();
}

void SweepWalker::start(HostTime now) {
  commander_.arm(arm_angle_deg());
  enter(SweepPhase::greeting, now);
}

void SweepWalker::tick(HostTime now) {
  if (left_leg_ && to_s(now - left_leg_->left) > last_frame_periods / frame_rate_hz())
    write_down_left_leg(now);
  if (watch_for_trouble(now)) return;
  switch (phase_) {
    case SweepPhase::greeting:
      return tick_greeting(now);
    case SweepPhase::opening_rest:
      if (to_s(now - phase_begin_) >= plan_.opening_rest_s) next_leg(now);
      return;
    case SweepPhase::transit:
      return tick_transit(now);
    case SweepPhase::leg:
      return tick_leg(now);
    case SweepPhase::recovering:
      return tick_recovering(now);
    case SweepPhase::closing_rest:
      if (to_s(now - phase_begin_) >= plan_.closing_rest_s) halt(now);
      return;
    case SweepPhase::halting:
      return tick_halting(now);
    case SweepPhase::stopping:
      return tick_stopping(now);
    case SweepPhase::waiting:
    case SweepPhase::done:
      return;
  }
}

void SweepWalker::tick_greeting(HostTime now) {
  if (commander_.was_reset() || commander_.refusal()) return trouble(now, "the servo could not be armed");
  if (!commander_.idle() || !commander_.armed()) return;
  armed_since_ = commander_.last_ack();
  enter(SweepPhase::opening_rest, now);
}

void SweepWalker::next_leg(HostTime now) {
  if (step_ >= plan_.leg_rates_dps.size()) {
    plan_complete_ = true;
    commander_.halt();
    return enter(SweepPhase::closing_rest, now);
  }
  if (fits_from_here(rate_dps())) return begin_leg(now);
  const double target_deg = start_angle_deg(rate_dps());
  const double way_deg = std::abs(target_deg - last_telemetry_->state.angle_deg);
  commander_.go_to({.angle_deg = target_deg,
                    .rate_dps = servo_.max_rate_dps,
                    .acceleration_dps2 = servo_.acceleration_dps2});
  transit_target_deg_ = target_deg;
  transit_limit_ = now + from_s(duration_slack * way_deg / servo_.max_rate_dps + duration_extra_s);
  enter(SweepPhase::transit, now);
}

void SweepWalker::tick_transit(HostTime now) {
  const bool there = servo_at_rest() && std::abs(last_telemetry_->state.angle_deg - transit_target_deg_) <=
                                            transit_tolerance_deg;
  if (commander_.idle() && there) return begin_leg(now);
  if (now > transit_limit_) trouble(now, "the servo did not reach the start of the leg");
}

void SweepWalker::begin_leg(HostTime now) {
  leg_ = Leg{};
  leg_.number = ++last_number_;
  const auto limit_deg = angle_limit_deg(servo_);
  leg_.turn_back = limit_deg && travel_deg(rate_dps()) > 2.0 * *limit_deg;
  leg_.record = {.leg = leg_.number, .step = static_cast<int>(step_), .rate_dps = rate_dps()};
  leg_.run_rate_dps = rate_dps();
  send_run(now);
  enter(SweepPhase::leg, now);
}

void SweepWalker::send_run(HostTime now) {
  const int missing = std::max(1, plan_.frames_per_leg - leg_.record.frames);
  const double limit_s = 1e-3 * static_cast<double>(SERVO_LIMIT_RUN_MS);
  const double duration_s = std::min(limit_s, duration_slack * leg_duration_s(missing) + duration_extra_s);
  commander_.run({.leg = leg_.number,
                  .turn_back = leg_.turn_back,
                  .rate_dps = leg_.run_rate_dps,
                  .acceleration_dps2 = servo_.acceleration_dps2,
                  .duration_s = duration_s});
  leg_.run_ends = now + from_s(duration_s);
}

void SweepWalker::tick_leg(HostTime now) {
  if (!leg_.acknowledged && commander_.idle()) note_leg_start(commander_.last_ack());
  if (has_its_frames(now)) return leave_leg(now);
  if (commander_.idle() && to_s(leg_.run_ends - now) < renew_before_s) {
    // On its way back the servo must not be turned round once more.
    const double driven_dps = last_telemetry_ ? last_telemetry_->state.rate_dps : 0.0;
    if (leg_.turn_back && driven_dps != 0.0) leg_.run_rate_dps = std::copysign(rate_dps(), driven_dps);
    send_run(now);
  }
}

// The last frame is awaited in its own time: it arrives when the middle of the next one may have passed, and
// that one would be labelled with this leg too. So the next command is given halfway between the two middles.
bool SweepWalker::has_its_frames(HostTime now) const {
  const int missing = plan_.frames_per_leg - leg_.record.frames;
  if (missing != 1 || !leg_.last_middle) return missing <= 0;
  return now >= *leg_.last_middle + from_s(1.5 / frame_rate_hz());
}

void SweepWalker::leave_leg(HostTime now) {
  leg_.left = now;
  if (leg_.record.frames >= plan_.frames_per_leg)
    write_down(leg_, true, now);
  else
    left_leg_ = leg_;
  failures_ = 0;
  ++step_;
  next_leg(now);
}

void SweepWalker::note_leg_start(HostTime acknowledged) {
  leg_.acknowledged = true;
  leg_.record.begin = acknowledged;
  event(acknowledged, EventKind::leg_start,
        fmt::format("leg {} (step {} of {}): {} deg/s{}", leg_.number, step_ + 1, plan_.leg_rates_dps.size(),
                    rate_dps(), leg_.turn_back ? ", back and forth" : ""));
}

void SweepWalker::write_down_left_leg(HostTime now) {
  if (left_leg_) write_down(*left_leg_, true, now);
  left_leg_.reset();
}

void SweepWalker::write_down(const Leg& leg, bool complete, HostTime now) {
  LegRecord record = leg.record;
  record.complete = complete;
  if (!leg.acknowledged) record.begin = now;
  if (record.frames == 0) record.end = now;
  legs_.push_back(record);
  event(now, EventKind::leg_end,
        fmt::format("leg {}: {} frames{}", record.leg, record.frames, complete ? "" : ", cut short"));
}

void SweepWalker::halt(HostTime now) {
  commander_.halt();
  enter(SweepPhase::halting, now);
}

void SweepWalker::tick_halting(HostTime now) {
  if (commander_.idle() && !disarm_sent_ && servo_at_rest()) {
    commander_.disarm();
    disarm_sent_ = true;
  } else if (commander_.idle() && disarm_sent_ && servo_is_disarmed()) {
    at_rest_ = true;
    enter(SweepPhase::done, now);
  } else if (to_s(now - phase_begin_) > halt_patience_s) {
    throw Error(ExitCode::device_lost, "the servo does not come to rest", "servo",
                "switch its supply off, then look at it");
  }
}

// ---- trouble ------------------------------------------------------------------------------------------

bool SweepWalker::watch_for_trouble(HostTime now) {
  const bool driving = phase_ == SweepPhase::opening_rest || phase_ == SweepPhase::transit ||
                       phase_ == SweepPhase::leg || phase_ == SweepPhase::closing_rest ||
                       phase_ == SweepPhase::halting;
  if (!driving || !last_telemetry_ || disarm_sent_) return false;
  if (commander_.was_reset()) {
    trouble(now, "the servo's board was reset");
    return true;
  }
  const bool fresh = last_telemetry_->stamp.time > armed_since_;
  const ServoFault fault = last_telemetry_->state.fault;
  if (!commander_.refusal() && (!fresh || fault == ServoFault::none)) return false;
  trouble(now, fault_text(fault));
  return true;
}

void SweepWalker::trouble(HostTime now, const std::string& what) {
  event(now, EventKind::servo_fault, what);
  write_down_left_leg(now);
  if (phase_ == SweepPhase::leg) write_down(leg_, false, now);
  if (++failures_ > failures_allowed)
    throw Error(ExitCode::device_lost, fmt::format("{}; {} attempts in a row failed", what, failures_),
                "servo", "look at cable, supply and travel of the servo, then record again");
  if (phase_ == SweepPhase::leg || phase_ == SweepPhase::transit) {
    ++repeated_;
    event(now, EventKind::leg_repeated,
          fmt::format("step {} of {} is driven again", step_ + 1, plan_.leg_rates_dps.size()));
  }
  if (phase_ != SweepPhase::recovering) resume_ = phase_;
  commander_.clear();
  rearm_sent_ = false;
  if (commander_.was_reset()) commander_.greet();
  enter(SweepPhase::recovering, now);
}

void SweepWalker::tick_recovering(HostTime now) {
  if (to_s(now - phase_begin_) > rearm_patience_s)
    throw Error(ExitCode::device_lost, "the servo cannot be armed again after a fault", "servo",
                "look at cable and supply of the servo, then record again");
  if (commander_.was_reset()) return trouble(now, "the servo's board was reset");
  if (!commander_.idle() || !servo_at_rest()) return;
  if (rearm_sent_ && commander_.armed() && !commander_.refusal()) return resume(now);
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
  if (phase_ == SweepPhase::leg) write_down(leg_, false, now);
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

// ---- what comes out -----------------------------------------------------------------------------------

void SweepWalker::event(HostTime now, EventKind kind, std::string message) {
  events_.push_back({.time = now, .kind = kind, .source = Device::servo, .message = std::move(message)});
}

std::vector<RecordingEvent> SweepWalker::take_events() {
  return std::exchange(events_, {});
}

std::vector<LegRecord> SweepWalker::take_legs() {
  return std::exchange(legs_, {});
}

}  // namespace thermorig::rig

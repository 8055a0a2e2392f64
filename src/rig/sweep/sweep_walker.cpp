// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/sweep_walker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "servo_link.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig {

namespace {

constexpr double duration_slack = 1.5;     // a leg may take so much longer than expected ...
constexpr double duration_extra_s = 2.0;   // ... and so much more, before its RUN ends
constexpr double renew_before_s = 1.0;     // a RUN that would end so soon is renewed
constexpr double doubtful_periods = 0.02;  // so close to a leg's end the labels may see a frame otherwise
constexpr double angle_tolerance_deg = 0.05;

bool drives(SweepPhase phase) {
  return phase == SweepPhase::opening_rest || phase == SweepPhase::transit || phase == SweepPhase::leg ||
         phase == SweepPhase::closing_rest || phase == SweepPhase::halting;
}

// The last frame is awaited in its own time: it arrives when the middle of the next one may have passed, and
// that one would be labelled with this leg too. So the next command is given halfway between the two middles.
bool has_its_frames(const DrivenLeg& leg, const Step& step, const FrameSchedule& frames, HostTime now) {
  const bool await_it = step.was_short || leg.record().frames == 0;
  if (leg.missing() != 1 || await_it) return leg.missing() <= 0;
  return now >= frames.next_middle() + frames.period() / 2;
}

}  // namespace

SweepWalker::SweepWalker(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz,
                         ServoDriver& commander)
    : plan_(plan),
      servo_(servo),
      commander_(commander),
      frames_(nominal_frame_rate_hz),
      steps_(plan),
      quota_(plan, servo, nominal_frame_rate_hz),
      recovery_(commander),
      stop_(commander) {}

// ---- what comes in ------------------------------------------------------------------------------------

void SweepWalker::frame(const TimedFrame& frame) {
  frames_.frame(frame);
  quota_.frame();
  const HostDuration doubt = from_s(doubtful_periods / frames_.rate_hz());
  const HostTime middle = newest_middle(frame);
  if (phase_ == SweepPhase::leg) leg_.frame(middle, frame.stamp.arrival, doubt);
  if (!left_leg_) return;
  left_leg_->frame(middle, frame.stamp.arrival, doubt, frames_.delay());
  if (left_leg_->is_settled()) settle_left_leg(frame.stamp.arrival);
}

void SweepWalker::telemetry(const TimedServo& servo) {
  telemetry_.take(servo);
  if (phase_ == SweepPhase::leg && servo.state.leg == leg_.record().leg &&
      servo.state.fault == ServoFault::none)
    leg_.seen(servo.stamp.time);
}

// ---- phases -------------------------------------------------------------------------------------------

void SweepWalker::enter(SweepPhase phase, HostTime now) {
  if (phase == SweepPhase::done) settle_left_leg(now);
  phase_ = phase;
  phase_begin_ = now;
}

void SweepWalker::start(HostTime now) {
  if (!servo_.is_there()) return enter(SweepPhase::by_hand, now);
  commander_.arm(telemetry_.arm_angle_deg(servo_));
  enter(SweepPhase::greeting, now);
}

void SweepWalker::tick(HostTime now) {
  if (left_leg_ && now > left_leg_->left() + frames_.delay() + frames_.period()) settle_left_leg(now);
  if (drives(phase_)) judge_driven_steps(now);
  if (watch_for_trouble(now)) return;
  const HostDuration passed = now - phase_begin_;
  switch (phase_) {
    case SweepPhase::greeting:
      return tick_greeting(now);
    case SweepPhase::opening_rest:
      if (to_s(passed) >= plan_.opening_rest_s && (steps_.empty() || frames_.is_between_frames(now)))
        next_leg(now);
      return;
    case SweepPhase::transit:
      return tick_transit(now);
    case SweepPhase::leg:
      return tick_leg(now);
    case SweepPhase::recovering:
      return tick_recovering(now);
    case SweepPhase::closing_rest:
      return tick_closing_rest(now);
    case SweepPhase::halting:
      if (!stop_.has_halted(passed, telemetry_)) return;
      news_.is_complete = true;
      return enter(SweepPhase::done, now);
    case SweepPhase::stopping:
      return tick_stopping(now);
    case SweepPhase::by_hand:
      if (by_hand_s_ + to_s(passed) < plan_.opening_rest_s) return;
      news_.is_complete = true;
      return enter(SweepPhase::done, now);
    case SweepPhase::waiting:
    case SweepPhase::awaiting:
    case SweepPhase::done:
      return;
  }
}

void SweepWalker::tick_greeting(HostTime now) {
  if (commander_.was_reset() || commander_.refusal()) return trouble(now, "the servo could not be armed");
  if (!commander_.idle() || !commander_.armed()) return;
  telemetry_.armed(commander_.last_ack());
  enter(SweepPhase::opening_rest, now);
}

void SweepWalker::next_leg(HostTime now) {
  if (steps_.empty() && plan_.repeat) steps_.fill();
  if (leg_.record().leg == plan_.last_leg && !steps_.empty()) {
    steps_.clear();
    event(now, EventKind::warning, fmt::format("no leg number is left after leg {}", leg_.record().leg));
  }
  if (steps_.empty()) {
    commander_.halt();
    return enter(SweepPhase::closing_rest, now);
  }
  const ServoTravel travel(servo_);
  const double rate_dps = steps_.rate_dps();
  const double rate_hz = frames_.arrival_rate_hz();
  const double way_deg = travel.way_deg(rate_dps, quota_.leg_frames(steps_.front().index, rate_hz), rate_hz);
  if (!telemetry_.has_come() ||
      travel.has_room(rate_dps, way_deg, telemetry_.angle_deg(), angle_tolerance_deg))
    return begin_leg(now);
  const double target_deg = ServoTravel::start_deg(rate_dps, way_deg);
  const double expected_s = std::abs(target_deg - telemetry_.angle_deg()) / servo_.max_rate_dps;
  commander_.go_to({.angle_deg = target_deg,
                    .rate_dps = servo_.max_rate_dps,
                    .acceleration_dps2 = servo_.acceleration_dps2});
  transit_ = {target_deg, now + from_s(duration_slack * expected_s + duration_extra_s)};
  enter(SweepPhase::transit, now);
}

void SweepWalker::tick_transit(HostTime now) {
  const bool there =
      telemetry_.at_rest() && std::abs(telemetry_.angle_deg() - transit_.target_deg) <= angle_tolerance_deg;
  if (commander_.idle() && there && frames_.is_between_frames(now)) return begin_leg(now);
  if (now > transit_.limit) trouble(now, "the servo did not reach the start of the leg");
}

// A leg that follows upon rest begins as one that follows upon a leg does: far from the middle of any frame,
// so that nobody counts its first frame otherwise when the camera's latency is known better. A number names
// one leg, in the servo's telemetry and in the session, and 0 names none.
void SweepWalker::begin_leg(HostTime now) {
  const LegRecord record{.leg = static_cast<std::uint16_t>(leg_.record().leg + 1),
                         .step = static_cast<int>(steps_.front().index),
                         .rate_dps = steps_.rate_dps()};
  const double rate_hz = frames_.arrival_rate_hz();
  const bool turn_back = ServoTravel(servo_).is_too_short_for(
      record.rate_dps, quota_.leg_frames(steps_.front().index, rate_hz), rate_hz);
  leg_ = DrivenLeg(record, plan_.frames_per_leg, turn_back);
  quota_.begin(record);
  send_run(now);
  enter(SweepPhase::leg, now);
}

void SweepWalker::send_run(HostTime now) {
  const double limit_s = 1e-3 * static_cast<double>(SERVO_LIMIT_RUN_MS);
  const double frames = std::max(
      {1.0, 1.0 * leg_.missing(), quota_.frames_needed(steps_.front().index, frames_.arrival_rate_hz())});
  const double expected_s = leg_duration_s(frames, frames_.arrival_rate_hz());
  const double duration_s = std::min(limit_s, duration_slack * expected_s + duration_extra_s);
  commander_.run({.leg = leg_.record().leg,
                  .turn_back = leg_.turn_back(),
                  .rate_dps = leg_.run_rate_dps(),
                  .acceleration_dps2 = servo_.acceleration_dps2,
                  .duration_s = duration_s});
  leg_.run_until(now + from_s(duration_s));
}

// After this computer stood still, frames that were sent meanwhile may come before the news that the servo's
// watchdog, or the end of its leg, has stopped it: a leg ends only where it is known that the servo has
// driven it so far.
void SweepWalker::tick_leg(HostTime now) {
  const LegRecord& record = leg_.record();
  if (!leg_.acknowledged() && commander_.idle()) {
    leg_.acknowledge(commander_.last_ack());
    event(
        record.begin, EventKind::leg_start,
        fmt::format("leg {} (step {} of {}): {} deg/s{}", record.leg, steps_.number(),
                    plan_.leg_rates_dps.size(), record.rate_dps, leg_.turn_back() ? ", back and forth" : ""));
  }
  if (telemetry_.is_recent(now) && has_its_frames(leg_, steps_.front(), frames_, now) && !extend_leg(now))
    return leave_leg(now);
  if (commander_.idle() && to_s(leg_.run_ends() - now) < renew_before_s) {
    leg_.keep_direction(telemetry_.rate_dps());
    send_run(now);
  }
}

/// The leg has its frames: goes on if they are not valid enough. Says whether it does.
bool SweepWalker::extend_leg(HostTime now) {
  const LegRecord& record = leg_.record();
  if (quota_.missing(leg_) == 0 || gives_up(steps_.front().index, record.frames, now)) return false;
  const int wanted = quota_.frames_wanted(leg_, frames_.arrival_rate_hz());
  const int fitting = leg_.turn_back() || !telemetry_.has_come()
                          ? plan_.frames_per_leg
                          : ServoTravel(servo_).frames_left(record.rate_dps, telemetry_.angle_deg(),
                                                            frames_.arrival_rate_hz(), plan_.frames_per_leg);
  const int more = std::min(leg_.turn_back() ? 1 : wanted, fitting);
  if (wanted <= 0 || more <= 0) return false;
  leg_.extend(more);
  return true;
}

/// Whether its step has its quota is seen when its frames have their labels.
void SweepWalker::leave_leg(HostTime now) {
  left_leg_.emplace(leg_, now);
  steps_.finish_front(quota_.samples_with(leg_), now);
  recovery_.leg_was_driven();
  if (left_leg_->is_settled()) settle_left_leg(now);
  next_leg(now);
}

// A leg that lacks its last frame is driven once more, after the one that has begun meanwhile.
void SweepWalker::settle_left_leg(HostTime now) {
  if (!left_leg_) return;
  const DrivenLeg leg = std::exchange(left_leg_, std::nullopt)->settled();
  write_down(leg, now);
  if (leg.is_whole() || has_ended()) return;
  const auto step = static_cast<std::size_t>(leg.record().step);
  steps_.drive_again({.index = step, .was_short = true});
  note_repeat(step, now);
}

void SweepWalker::write_down(const DrivenLeg& leg, HostTime now) {
  news_.legs.push_back(leg.closed(now));
  quota_.ended(leg.record());
  event(now, EventKind::leg_end,
        fmt::format("leg {}: {} frames{}", leg.record().leg, leg.record().frames,
                    leg.is_whole() ? "" : ", cut short"));
}

void SweepWalker::judge_driven_steps(HostTime now) {
  while (const auto step = steps_.take_labelled(quota_.samples(), now)) {
    if (quota_.missing(*step) == 0 || steps_.is_driven_again(*step) || gives_up(*step, 0, now)) continue;
    steps_.drive_again({.index = *step});
    note_repeat(*step, now);
  }
}

bool SweepWalker::gives_up(std::size_t step, int frames, HostTime now) {
  if (const auto why = quota_.give_up(step, frames)) event(now, EventKind::warning, *why);
  return quota_.is_given_up(step);
}

void SweepWalker::note_repeat(std::size_t step, HostTime now) {
  ++repeated_;
  event(now, EventKind::leg_repeated,
        fmt::format("repeating step {} of {}", step + 1, plan_.leg_rates_dps.size()));
}

void SweepWalker::tick_closing_rest(HostTime now) {
  if (left_leg_ || steps_.awaits_labels()) return;  // it may have to be driven again
  if (!steps_.empty()) return frames_.is_between_frames(now) ? next_leg(now) : void();
  if (to_s(now - phase_begin_) < plan_.closing_rest_s) return;
  commander_.halt();
  enter(SweepPhase::halting, now);
}

void SweepWalker::request_stop(HostTime now) {
  if (has_ended()) return;
  if (phase_ == SweepPhase::leg) write_down(leg_, now);
  if (!servo_.is_there()) return enter(SweepPhase::done, now);
  enter(stop_.request() ? SweepPhase::stopping : SweepPhase::done, now);
}

void SweepWalker::tick_stopping(HostTime now) {
  const ServoStop::Request request = stop_.requested_at(phase_begin_, now, telemetry_);
  if (request == ServoStop::Request::under_way) return;
  if (request == ServoStop::Request::unconfirmed)
    event(now, EventKind::warning, "the stop was not confirmed; " + commander_.how_it_rests());
  enter(SweepPhase::done, now);
}

// ---- trouble, and devices that go and come back ---------------------------------------------------------

bool SweepWalker::watch_for_trouble(HostTime now) {
  if (!drives(phase_) || !telemetry_.has_come() || stop_.is_disarming()) return false;
  const ServoFault fault = telemetry_.fault();
  const bool is_new = telemetry_.is_newer_than_arming() && fault != ServoFault::none;
  if (commander_.was_reset())
    trouble(now, "the servo's board was reset");
  else if (commander_.refusal() || is_new)
    trouble(now, fault_text(fault), fault);
  else
    return false;
  return true;
}

void SweepWalker::trouble(HostTime now, const std::string& what, ServoFault fault) {
  event(now, EventKind::servo_fault, what);
  if (phase_ == SweepPhase::leg) leg_.broke_off();
  write_down_cut_leg(now);
  recovery_.count_failure(what, fault);
  repeat_cut_leg(now);
  recovery_.begin_after_failure(phase_);
  enter(SweepPhase::recovering, now);
}

void SweepWalker::suspend(HostTime now, const Error& why) {
  if (phase_ == SweepPhase::by_hand) {
    by_hand_s_ += to_s(now - phase_begin_);
    return enter(SweepPhase::awaiting, now);
  }
  if (!drives(phase_) && phase_ != SweepPhase::greeting && phase_ != SweepPhase::recovering) return;
  if (phase_ == SweepPhase::halting) return;  // nothing more is asked of any device but the servo
  write_down_cut_leg(now);
  repeat_cut_leg(now);
  const SweepPhase interrupted = phase_;
  enter(SweepPhase::awaiting, now);
  recovery_.device_went(interrupted, why);
}

void SweepWalker::write_down_cut_leg(HostTime now) {
  settle_left_leg(now);
  if (phase_ == SweepPhase::leg) write_down(leg_, now);
}

void SweepWalker::repeat_cut_leg(HostTime now) {
  if (phase_ == SweepPhase::leg && leg_.is_whole())
    steps_.finish_front(quota_.samples_with(leg_), now);
  else if (phase_ == SweepPhase::leg || phase_ == SweepPhase::transit)
    note_repeat(steps_.front().index, now);
}

void SweepWalker::go_on(HostTime now) {
  if (phase_ != SweepPhase::awaiting) return;
  if (!servo_.is_there()) return enter(SweepPhase::by_hand, now);
  recovery_.device_is_back(telemetry_.fault() != ServoFault::none);
  enter(SweepPhase::recovering, now);
}

void SweepWalker::tick_recovering(HostTime now) {
  const double passed_s = to_s(now - phase_begin_);
  recovery_.check_patience(passed_s);
  if (commander_.was_reset()) return trouble(now, "the servo's board was reset");
  if (!recovery_.is_armed_again(passed_s, telemetry_.at_rest(), telemetry_.arm_angle_deg(servo_))) return;
  if (const auto warning = recovery_.finish(passed_s)) event(now, EventKind::warning, *warning);
  telemetry_.armed(commander_.last_ack());
  const SweepPhase interrupted = recovery_.interrupted();
  if (interrupted == SweepPhase::leg || interrupted == SweepPhase::transit) return next_leg(now);
  const bool before_legs = interrupted == SweepPhase::greeting || interrupted == SweepPhase::opening_rest;
  enter(before_legs ? SweepPhase::opening_rest : SweepPhase::closing_rest, now);
}

// ---- what comes out -----------------------------------------------------------------------------------

void SweepWalker::event(HostTime now, EventKind kind, std::string message) {
  news_.events.push_back({.time = now, .kind = kind, .source = Device::servo, .message = std::move(message)});
}

}  // namespace thermorig::rig

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

constexpr double duration_slack = 1.5;       // a leg may take so much longer than expected ...
constexpr double duration_extra_s = 2.0;     // ... and so much more, before its RUN ends
constexpr double renew_before_s = 1.0;       // a RUN that would end so soon is renewed
constexpr double last_frame_periods = 2.0;   // a leg's last frame is awaited for so long
constexpr double doubtful_periods = 0.02;    // so close to a leg's end the labels may see a frame otherwise
constexpr double half_way_tolerance = 0.15;  // periods: more than a tick
constexpr double transit_tolerance_deg = 0.05;
constexpr double halt_patience_s = 5.0;
constexpr auto telemetry_is_recent = std::chrono::milliseconds(100);  // the servo's watchdog waits for longer

}  // namespace

std::string name_of(SweepPhase phase) {
  constexpr const char* names[] = {
      "waiting",      "greeting", "opening rest", "transit", "leg", "recovering", "waiting for a device",
      "closing rest", "halting",  "stopping",     "done"};
  return names[static_cast<std::size_t>(phase)];
}

SweepWalker::SweepWalker(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz,
                         ServoCommander& commander)
    : plan_(plan),
      servo_(servo),
      frames_(nominal_frame_rate_hz),
      commander_(commander),
      quota_(plan),
      expected_(expected_legs(plan, servo, nominal_frame_rate_hz)),
      driven_frames_(plan.leg_rates_dps.size(), 0),
      given_up_(plan.leg_rates_dps.size(), false) {
  fill_steps();
}

void SweepWalker::fill_steps() {
  for (std::size_t i = 0; i < plan_.leg_rates_dps.size(); ++i) to_drive_.push_back({.index = i});
}

// ---- what comes in ------------------------------------------------------------------------------------

void SweepWalker::frame(const TimedFrame& frame) {
  frames_.frame(frame);
  ++frames_seen_;
  const HostDuration doubt = from_s(doubtful_periods / frames_.rate_hz());
  const HostTime middle = newest_middle(frame);
  if (phase_ == SweepPhase::leg) leg_.frame(middle, frame.stamp.arrival, doubt);
  if (left_leg_) frame_of_left_leg(middle, frame.stamp.arrival, doubt);
}

// Where a frame is lost, a clock that knows the past alone takes the next one for it, read late. Halfway
// between the arrivals of the two, the later is doubted; it is the last one after all if one more comes in
// time.
void SweepWalker::frame_of_left_leg(HostTime middle, HostTime arrival, HostDuration doubt) {
  ++frames_since_left_;
  if (!left_leg_->is_over()) {
    left_leg_->frame(middle, arrival, doubt);
    last_is_late_ = left_leg_->missing() <= 0 && arrival > *left_leg_->left() + frames_.delay();
  }
  if (left_leg_->is_over() && (!last_is_late_ || frames_since_left_ > 1)) {
    last_is_late_ = false;
    settle_left_leg(arrival);
  }
}

void SweepWalker::telemetry(const TimedServo& servo) {
  last_telemetry_ = servo;
  if (servo.state.motion != ServoMotion::disarmed) driven_angle_deg_ = servo.state.angle_deg;
  if (phase_ == SweepPhase::leg && servo.state.leg == leg_.record().leg && !is_faulty())
    leg_.seen(servo.stamp.time);
}

// ---- phases -------------------------------------------------------------------------------------------

void SweepWalker::enter(SweepPhase phase, HostTime now) {
  if (phase == SweepPhase::done) settle_left_leg(now);
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
  if (left_leg_ && now > *left_leg_->left() + frames_.delay() + frames_.period()) settle_left_leg(now);
  if (drives()) judge_open_steps(now);
  if (watch_for_trouble(now)) return;
  switch (phase_) {
    case SweepPhase::greeting:
      return tick_greeting(now);
    case SweepPhase::opening_rest:
      if (to_s(now - phase_begin_) >= plan_.opening_rest_s && is_between_frames(now)) next_leg(now);
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
      return tick_halting(now);
    case SweepPhase::stopping:
      return tick_stopping(now);
    case SweepPhase::waiting:
    case SweepPhase::awaiting:
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
  if (to_drive_.empty() && plan_.repeat) fill_steps();
  if (last_number_ == plan_.last_leg) give_up_steps(now);
  if (to_drive_.empty()) {
    commander_.halt();
    return enter(SweepPhase::closing_rest, now);
  }
  if (fits_from_here()) return begin_leg(now);
  const double target_deg = start_angle_deg();
  const double way_deg = std::abs(target_deg - last_telemetry_->state.angle_deg);
  commander_.go_to({.angle_deg = target_deg,
                    .rate_dps = servo_.max_rate_dps,
                    .acceleration_dps2 = servo_.acceleration_dps2});
  transit_target_deg_ = target_deg;
  transit_limit_ = now + from_s(duration_slack * way_deg / servo_.max_rate_dps + duration_extra_s);
  enter(SweepPhase::transit, now);
}

// A number names one leg, in the servo's telemetry and in the session, and 0 names none.
void SweepWalker::give_up_steps(HostTime now) {
  if (to_drive_.empty()) return;
  to_drive_.clear();
  event(now, EventKind::warning, fmt::format("leg {} was the last one that has a number", last_number_));
}

void SweepWalker::tick_transit(HostTime now) {
  const bool there = servo_at_rest() && std::abs(last_telemetry_->state.angle_deg - transit_target_deg_) <=
                                            transit_tolerance_deg;
  if (commander_.idle() && there && is_between_frames(now)) return begin_leg(now);
  if (now > transit_limit_) trouble(now, "the servo did not reach the start of the leg");
}

void SweepWalker::begin_leg(HostTime now) {
  const LegRecord record{
      .leg = ++last_number_, .step = static_cast<int>(to_drive_.front().index), .rate_dps = rate_dps()};
  const auto limit_deg = angle_limit_deg(servo_);
  const bool turn_back = limit_deg && travel_deg() > 2.0 * *limit_deg;
  leg_ = DrivenLeg(record, plan_.frames_per_leg, turn_back);
  quota_.leg(record.leg, record.rate_dps);
  fruitless_ = 0;
  send_run(now);
  enter(SweepPhase::leg, now);
}

void SweepWalker::send_run(HostTime now) {
  const double limit_s = 1e-3 * static_cast<double>(SERVO_LIMIT_RUN_MS);
  const double expected_s = leg_duration_s(std::max({1.0, 1.0 * leg_.missing(), frames_to_quota()}));
  const double duration_s = std::min(limit_s, duration_slack * expected_s + duration_extra_s);
  commander_.run({.leg = leg_.record().leg,
                  .turn_back = leg_.turn_back(),
                  .rate_dps = leg_.run_rate_dps(),
                  .acceleration_dps2 = servo_.acceleration_dps2,
                  .duration_s = duration_s});
  run_ends_ = now + from_s(duration_s);
}

void SweepWalker::tick_leg(HostTime now) {
  if (!leg_.acknowledged() && commander_.idle()) note_leg_start(commander_.last_ack());
  if (servo_is_heard(now) && has_its_frames(now) && !extend_leg(now)) return leave_leg(now);
  if (commander_.idle() && to_s(run_ends_ - now) < renew_before_s) {
    leg_.keep_direction(last_telemetry_ ? last_telemetry_->state.rate_dps : 0.0);
    send_run(now);
  }
}

// After this computer stood still, frames that were sent meanwhile may come before the news that the servo's
// watchdog has stopped it: a leg ends only where it is known that the servo has driven it so far.
bool SweepWalker::servo_is_heard(HostTime now) const {
  return last_telemetry_ && now - last_telemetry_->stamp.time <= telemetry_is_recent;
}

// The last frame is awaited in its own time: it arrives when the middle of the next one may have passed, and
// that one would be labelled with this leg too. So the next command is given halfway between the two middles.
bool SweepWalker::has_its_frames(HostTime now) const {
  const bool await_it = to_drive_.front().was_short || leg_.record().frames == 0;
  if (leg_.missing() != 1 || await_it) return leg_.missing() <= 0;
  return now >= frames_.next_middle() + frames_.period() / 2;
}

// A leg that follows upon rest begins as one that follows upon a leg does: far from the middle of any frame,
// so that nobody counts its first frame otherwise when the camera's latency is known better.
bool SweepWalker::is_between_frames(HostTime now) const {
  if (!frames_.has_frames() || to_drive_.empty()) return true;
  const double phase = std::abs(to_s(now - frames_.next_middle())) * frames_.rate_hz();
  return std::abs(phase - std::floor(phase) - 0.5) < half_way_tolerance;
}

void SweepWalker::leave_leg(HostTime now) {
  leg_.leave(now);
  left_leg_ = leg_;
  frames_since_left_ = 0;
  last_is_late_ = false;
  finish_step(now);
  failures_ = interruptions_ = 0;
  if (left_leg_->is_over()) settle_left_leg(now);
  next_leg(now);
}

void SweepWalker::note_leg_start(HostTime acknowledged) {
  leg_.acknowledge(acknowledged);
  event(acknowledged, EventKind::leg_start,
        fmt::format("leg {} (step {} of {}): {} deg/s{}", leg_.record().leg, step_number(),
                    plan_.leg_rates_dps.size(), rate_dps(), leg_.turn_back() ? ", back and forth" : ""));
}

// A leg that lacks its last frame is driven once more, after the one that has begun meanwhile.
void SweepWalker::settle_left_leg(HostTime now) {
  if (!left_leg_) return;
  DrivenLeg leg = *std::exchange(left_leg_, std::nullopt);
  if (std::exchange(last_is_late_, false)) leg.take_back();
  write_down(leg, now);
  if (leg.is_whole() || phase_ == SweepPhase::stopping || phase_ == SweepPhase::done) return;
  drive_again({.index = static_cast<std::size_t>(leg.record().step), .was_short = true}, now);
}

void SweepWalker::write_down(const DrivenLeg& leg, HostTime now) {
  legs_.push_back(leg.closed(now));
  driven_frames_[static_cast<std::size_t>(leg.record().step)] += leg.record().frames;
  event(now, EventKind::leg_end,
        fmt::format("leg {}: {} frames{}", leg.record().leg, leg.record().frames,
                    leg.is_whole() ? "" : ", cut short"));
}

void SweepWalker::note_repeat(std::size_t step, HostTime now) {
  ++repeated_;
  event(now, EventKind::leg_repeated,
        fmt::format("step {} of {} is driven again", step + 1, plan_.leg_rates_dps.size()));
}

void SweepWalker::tick_closing_rest(HostTime now) {
  if (left_leg_ || !open_steps_.empty()) return;  // it may have to be driven again
  if (!to_drive_.empty() && is_between_frames(now)) return next_leg(now);
  if (!to_drive_.empty()) return;
  if (to_s(now - phase_begin_) >= plan_.closing_rest_s) halt(now);
}

void SweepWalker::halt(HostTime now) {
  plan_complete_ = true;
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

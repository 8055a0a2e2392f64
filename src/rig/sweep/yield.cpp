// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/yield.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "servo_travel.h"

namespace thermorig::rig {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
// How far the shaft's speed may leave the commanded one in a valid frame: reason servo_ramp.
constexpr double tolerance_least_dps = 1.0;
constexpr double tolerance_share = 0.02;

// Two refresh periods: a half-fresh frame holds halves that were exposed one after the other.
double exposure_s(double frame_rate_hz) {
  return 2.0 / frame_rate_hz;
}

double ramps_deg(double rate_dps, const ServoProfile& servo) {
  return rate_dps * rate_dps / servo.acceleration_dps2;  // one at either end
}

/// The servo's own loop, of second order with damping 0.7, at its end of a ramp.
class Loop {
 public:
  explicit Loop(const ServoProfile& servo)
      : acceleration_dps2_(servo.acceleration_dps2), loop_rad_(2.0 * std::numbers::pi * servo.loop_hz) {}

  /// How far the shaft's speed is behind, `t` seconds after the end of a ramp that was long.
  double error_dps(double t) const {
    const double oscillation_rad = loop_rad_ * std::sqrt(1.0 - damping * damping);
    const double lag_s = 2.0 * damping / loop_rad_;
    const double swing_s = (2.0 * damping * damping - 1.0) / oscillation_rad;
    return acceleration_dps2_ * std::exp(-damping * loop_rad_ * t) *
           (lag_s * std::cos(oscillation_rad * t) + swing_s * std::sin(oscillation_rad * t));
  }

  /// What the shaft's speed has changed by, `t` seconds after the begin of a ramp.
  double drop_dps(double t) const { return acceleration_dps2_ * t - (error_dps(0.0) - error_dps(t)); }

 private:
  static constexpr double damping = 0.7;
  double acceleration_dps2_;
  double loop_rad_;
};
constexpr double loop_step_s = 0.001;

std::array<SpeedYield::Windows, window_frames_max> windows_of(const ExpectedLeg& leg,
                                                              const ServoProfile& servo,
                                                              double frame_rate_hz) {
  std::array<SpeedYield::Windows, window_frames_max> all;
  for (int frames = 1; frames <= window_frames_max; ++frames) {
    SpeedYield::Windows& windows = all[static_cast<std::size_t>(frames - 1)];
    const LegYield yield = leg_yield(leg.course, leg.frames, frames, frame_rate_hz);
    windows.sweep =
        windows_within(sweep_constant_s(leg.rate_dps, servo), leg.course.settling_s, frames, frame_rate_hz);
    windows.leg = yield.own + yield.other;
    windows.travel_deg = window_travel_deg(leg.rate_dps, frames, servo, frame_rate_hz);
    windows.possible = windows.travel_deg <= stroke_deg(servo);
  }
  return all;
}

}  // namespace

double window_s(int frames, const ServoProfile& servo, double frame_rate_hz) {
  return servo.settle_s + exposure_s(frame_rate_hz) + (frames - 1) / frame_rate_hz;
}

double window_travel_deg(double rate_dps, int frames, const ServoProfile& servo, double frame_rate_hz) {
  return std::abs(rate_dps) * window_s(frames, servo, frame_rate_hz) + ramps_deg(rate_dps, servo);
}

double sweep_constant_s(double rate_dps, const ServoProfile& servo) {
  return std::max(0.0, stroke_deg(servo) - ramps_deg(rate_dps, servo)) / std::abs(rate_dps);
}

// Where a ramp ends, what the loop lags behind dies away; where the next one begins, the shaft keeps the
// speed for a little longer. A pure delay shifts both alike.
double settling_s(double rate_dps, const ServoProfile& servo) {
  const Loop loop(servo);
  const double tolerance_dps = std::max(tolerance_least_dps, tolerance_share * std::abs(rate_dps));
  const double ramp_s = 2.0 * std::abs(rate_dps) / servo.acceleration_dps2;  // a reversal's
  double settled_s = 0.0, kept_s = 0.0;
  for (double t = 0.0; t < servo.settle_s; t += loop_step_s) {
    if (std::abs(loop.error_dps(t) - loop.error_dps(t + ramp_s)) > tolerance_dps) settled_s = t + loop_step_s;
    if (loop.drop_dps(t) <= tolerance_dps) kept_s = t;
  }
  return std::clamp(settled_s - kept_s, 0.0, servo.settle_s);
}

// Frames come every period at a phase that is not known: on average so many begin early enough to end in
// time.
double windows_within(double constant_s, double settling_s, int frames, double frame_rate_hz) {
  const double needed_s = settling_s + exposure_s(frame_rate_hz) + (frames - 1) / frame_rate_hz;
  return std::max(0.0, (constant_s - needed_s) * frame_rate_hz);
}

bool LegCourse::turns_back() const {
  return std::isfinite(constant_s);
}

LegCourse leg_course(double rate_dps, double before_dps, double frames, const ServoProfile& servo,
                     double frame_rate_hz) {
  const double acceleration_dps2 = servo.acceleration_dps2;
  const double settle = settling_s(rate_dps, servo);
  if (leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2) <= stroke_deg(servo))
    return {std::abs(rate_dps - before_dps) / acceleration_dps2, settle, endless, 0.0};
  const double ramp_s = std::abs(rate_dps) / acceleration_dps2;
  return {ramp_s, settle, sweep_constant_s(rate_dps, servo), 2.0 * ramp_s};
}

LegYield leg_yield(const LegCourse& course, double frames, int window_frames, double frame_rate_hz) {
  const double driven_s = std::max(0.0, frames / frame_rate_hz - course.ramp_s);
  const auto windows = [&](double constant_s) {
    return windows_within(constant_s, course.settling_s, window_frames, frame_rate_hz);
  };
  if (!course.turns_back()) return {windows(driven_s), 0.0};
  const double stroke_s = course.constant_s + course.reversal_s;
  const double whole = std::floor(driven_s / stroke_s);
  const double each = windows(course.constant_s);
  const double last = windows(std::min(course.constant_s, driven_s - whole * stroke_s));
  LegYield yield{each * std::ceil(whole / 2.0), each * std::floor(whole / 2.0)};
  (std::fmod(whole, 2.0) == 0.0 ? yield.own : yield.other) += last;
  return yield;
}

double frames_for(double valid, const LegCourse& course, double frame_rate_hz) {
  if (valid <= 0.0) return 0.0;
  double before_s = course.ramp_s;
  if (course.turns_back()) {
    const double each = windows_within(course.constant_s, course.settling_s, 1, frame_rate_hz);
    if (each <= 0.0) return endless;
    const double whole = std::ceil(valid / each) - 1.0;
    before_s += 2.0 * whole * (course.constant_s + course.reversal_s);
    valid -= whole * each;
  }
  const double lost_s = before_s + course.settling_s + exposure_s(frame_rate_hz);
  return std::ceil(lost_s * frame_rate_hz + valid);
}

std::vector<SpeedYield> plan_yield(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz) {
  std::map<double, SpeedYield> speeds;
  for (const ExpectedLeg& leg : expected_legs(plan, servo, frame_rate_hz)) {
    SpeedYield& speed = speeds[std::abs(leg.rate_dps)];
    if (speed.rate_dps == 0.0) {
      speed.rate_dps = std::abs(leg.rate_dps);
      speed.windows = windows_of(leg, servo, frame_rate_hz);
    }
    speed.duration_s += leg.transit_s + leg.duration_s;
  }
  std::vector<SpeedYield> ascending;
  for (const auto& [rate_dps, speed] : speeds) ascending.push_back(speed);
  return ascending;
}

// ---- how a plan goes, leg by leg: how long each takes, and where it leaves the servo
// -----------------------

namespace {

constexpr double command_s = 0.1;  // from one leg's end to the servo's start of the next
constexpr double transit_extra_s = 0.2;

/// Walks through a plan on paper.
class Walk {
 public:
  Walk(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz)
      : plan_(plan), servo_(servo), travel_(servo), frame_rate_hz_(frame_rate_hz) {}

  ExpectedLeg drive(double rate_dps) {
    ExpectedLeg leg{.rate_dps = rate_dps, .course = {}, .frames_for_quota = frames_for_quota(rate_dps)};
    const double planned = plan_.frames_per_leg;
    leg.frames = std::clamp(leg.frames_for_quota, planned, frames_growth_max * planned);
    leg.transit_s = go_to_start(rate_dps, leg.frames);
    leg.course = leg_course(rate_dps, before_dps_, leg.frames, servo_, frame_rate_hz_);
    leg.duration_s = leg_duration_s(leg.frames, frame_rate_hz_);
    const LegYield yield = leg_yield(leg.course, leg.frames, 1, frame_rate_hz_);
    valid_[rate_dps] += yield.own;
    valid_[-rate_dps] += yield.other;
    before_dps_ = leg.course.turns_back() ? 0.0 : rate_dps;
    return leg;
  }

 private:
  /// What earlier legs brought in this direction counts.
  double frames_for_quota(double rate_dps) {
    wanted_[rate_dps] += plan_.valid_per_leg;
    const double missing = wanted_[rate_dps] - valid_[rate_dps];
    const double planned = plan_.frames_per_leg;
    const LegCourse course = leg_course(rate_dps, before_dps_, planned, servo_, frame_rate_hz_);
    return frames_for(missing, course, frame_rate_hz_);
  }

  /// Seconds to where the leg fits. Leaves the servo where the leg ends.
  double go_to_start(double rate_dps, double frames) {
    const double way_deg = travel_.way_deg(rate_dps, frames, frame_rate_hz_);
    double transit_s = 0.0;
    if (!travel_.has_room(rate_dps, way_deg, angle_deg_)) {
      const double start_deg = ServoTravel::start_deg(rate_dps, way_deg);
      transit_s = std::abs(start_deg - angle_deg_) / speed_limit_dps(servo_) + transit_extra_s;
      angle_deg_ = start_deg;
      before_dps_ = 0.0;
    }
    angle_deg_ += sign_of(rate_dps) * way_deg;
    return transit_s;
  }

  const SweepPlan& plan_;
  const ServoProfile& servo_;
  ServoTravel travel_;
  double frame_rate_hz_;
  double angle_deg_ = 0.0;
  double before_dps_ = 0.0;
  std::map<double, double> wanted_;  // valid frames by speed, signed
  std::map<double, double> valid_;
};

}  // namespace

double leg_duration_s(double frames, double frame_rate_hz) {
  return (frames + 0.5) / frame_rate_hz + command_s;
}

std::vector<ExpectedLeg> expected_legs(const SweepPlan& plan, const ServoProfile& servo,
                                       double frame_rate_hz) {
  Walk walk(plan, servo, frame_rate_hz);
  std::vector<ExpectedLeg> legs;
  for (const double rate_dps : plan.leg_rates_dps) legs.push_back(walk.drive(rate_dps));
  return legs;
}

double plan_duration_s(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz) {
  double duration_s = plan.opening_rest_s + plan.closing_rest_s;
  for (const ExpectedLeg& leg : expected_legs(plan, servo, frame_rate_hz))
    duration_s += leg.transit_s + leg.duration_s;
  return duration_s;
}

}  // namespace thermorig::rig

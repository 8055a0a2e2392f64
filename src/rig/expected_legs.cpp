// SPDX-License-Identifier: MIT
// How a plan is expected to go, leg by leg: how long each takes, and where it leaves the servo.
#include <algorithm>
#include <cmath>
#include <map>

#include "servo_travel.h"
#include "thermorig/rig/yield.h"

namespace thermorig::rig {

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
    if (ServoTravel::end_deg(rate_dps, way_deg, angle_deg_) > travel_.limit_deg()) {
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

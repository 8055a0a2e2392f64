// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <span>

#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

namespace {

constexpr double quiet_s = 60.0;  // the bias's own noise is then far below its drift; or a turn by hand
constexpr double pause_s = 3.0;   // at rest before and after a motion: it shows the gyro's bias
constexpr double reversal_s = 2.0;
constexpr double fastest_reversal_dps = 120.0;
constexpr int reversals = 28;
constexpr double slow_rate_dps = 30.0;
constexpr double slow_sweep_s = 3.0;
constexpr int slow_sweeps = 12;     // fewer are too few witnesses in a room of little contrast
constexpr int turns_both_ways = 3;  // rooms of little contrast close only in several
constexpr double turn_deg = 420.0;  // the picture closes after 360: the rest overlaps
constexpr double turn_rate_dps = 40.0;
constexpr double lens_leg_s = 10.5;     // 420 deg at the slow speed
constexpr double lens_fast_dps = 60.0;  // images are still sharp
constexpr double lens_shares[] = {2.0 / 3.0, 1.0};
constexpr int lens_legs = 16;
constexpr double encoder_fast_dps = 200.0;
constexpr double encoder_usual_dps = 100.0;
constexpr double encoder_shortest_s = 1.5;
constexpr double encoder_longest_s = 6.0;
constexpr int encoder_legs = 12;
constexpr int encoder_short_legs = 36;
constexpr double check_rest_s = 4.0;  // seven spectra of the gyro's noise, with the closing one
constexpr double check_end_s = 2.0;
constexpr double check_leg_s = 3.0;
constexpr double check_slow_dps = 75.0;   // two legs of it are more than a turn, and images are still sharp
constexpr double check_fast_dps = 200.0;  // as fast as the paper's plan
constexpr double check_slow_share = 0.4;  // of the fast speed, where that is lower
constexpr double check_sweep_s = 1.0;     // a shaft has settled for half of that

int frames_in(double duration_s, const CameraProfile& camera) {
  return std::max(2, static_cast<int>(std::lround(duration_s * camera.output_rate_hz)));
}

/// The highest speed up to `wanted_dps` at which a leg of `frames` frames turns nowhere on its way.
double speed_within_stroke(double wanted_dps, int frames, const ServoProfile& servo,
                           const CameraProfile& camera) {
  constexpr double step_dps = 1.0;
  double rate_dps = std::min(wanted_dps, speed_limit_dps(servo));
  while (rate_dps > step_dps &&
         leg_travel_deg(rate_dps, frames, camera.output_rate_hz, servo.acceleration_dps2) > stroke_deg(servo))
    rate_dps -= step_dps;
  return rate_dps;
}

SweepPlan resting_plan(const std::string& name) {
  SweepPlan plan;
  plan.name = name;
  plan.for_calibration = true;
  plan.opening_rest_s = quiet_s;
  plan.closing_rest_s = 0.0;
  return plan;
}

SweepPlan moving_plan(const std::string& name, int frames_per_leg) {
  SweepPlan plan = resting_plan(name);
  plan.opening_rest_s = pause_s;
  plan.closing_rest_s = pause_s;
  plan.frames_per_leg = frames_per_leg;
  return plan;
}

/// There and back, `shares` of the fastest speed in turn.
void add_reversals(int legs, double fastest_dps, std::span<const double> shares, SweepPlan& plan) {
  for (int i = 0; i < legs / 2; ++i) {
    const double rate_dps = fastest_dps * shares[static_cast<std::size_t>(i) % shares.size()];
    plan.leg_rates_dps.insert(plan.leg_rates_dps.end(), {rate_dps, -rate_dps});
  }
}

// Each speed there and back, so that nothing lies between two legs but the reversal itself. Several speeds,
// so that a delay cannot be mistaken for a shift by a whole number of periods.
SweepPlan latency_plan(const ServoProfile& servo, const CameraProfile& camera) {
  constexpr double shares[] = {1.0, 0.625, 0.875, 0.5, 0.75};
  SweepPlan plan = moving_plan("calibrate-latency", frames_in(reversal_s, camera));
  const double fastest_dps = speed_within_stroke(fastest_reversal_dps, plan.frames_per_leg, servo, camera);
  add_reversals(reversals, fastest_dps, shares, plan);
  return plan;
}

SweepPlan orientation_plan(const ServoProfile& servo, const CameraProfile& camera) {
  SweepPlan plan = moving_plan("calibrate-orientation", frames_in(slow_sweep_s, camera));
  const double rate_dps = speed_within_stroke(slow_rate_dps, plan.frames_per_leg, servo, camera);
  for (int i = 0; i < slow_sweeps; ++i) plan.leg_rates_dps.push_back(i % 2 == 0 ? rate_dps : -rate_dps);
  return plan;
}

SweepPlan scale_plan(const ServoProfile& servo, const CameraProfile& camera) {
  SweepPlan plan = moving_plan("calibrate-scale", frames_in(turn_deg / turn_rate_dps, camera));
  const double rate_dps = speed_within_stroke(turn_rate_dps, plan.frames_per_leg, servo, camera);
  if (rate_dps < turn_rate_dps) return resting_plan("calibrate-scale");
  for (int i = 0; i < turns_both_ways; ++i)
    plan.leg_rates_dps.insert(plan.leg_rates_dps.end(), {rate_dps, -rate_dps});
  return plan;
}

SweepPlan lens_plan(const ServoProfile& servo, const CameraProfile& camera) {
  SweepPlan plan = moving_plan("calibrate-lens", frames_in(lens_leg_s, camera));
  const double fastest_dps = speed_within_stroke(lens_fast_dps, plan.frames_per_leg, servo, camera);
  add_reversals(lens_legs, fastest_dps, lens_shares, plan);
  return plan;
}

// Errors of the gyro that repeat with each turn count the less the faster it turns, and many turns show more.
// A servo of little travel has short legs instead of slow ones, and more of them.
SweepPlan encoder_plan(const ServoProfile& servo, const CameraProfile& camera) {
  constexpr double shares[] = {1.0, 0.75, 0.5};
  const double leg_s =
      std::clamp(stroke_deg(servo) / encoder_usual_dps, encoder_shortest_s, encoder_longest_s);
  SweepPlan plan = moving_plan("calibrate-encoder", frames_in(leg_s, camera));
  const double fastest_dps = speed_within_stroke(encoder_fast_dps, plan.frames_per_leg, servo, camera);
  add_reversals(leg_s < encoder_longest_s ? encoder_short_legs : encoder_legs, fastest_dps, shares, plan);
  return plan;
}

// The slow speed first: the fast one is held against what it reaches. Two legs of it in a row are a
// turn, and images tell it more surely there and back.
SweepPlan check_plan_of(const ServoProfile& servo, const CameraProfile& camera) {
  SweepPlan plan = moving_plan("calibrate-check", frames_in(check_leg_s, camera));
  plan.opening_rest_s = check_rest_s;
  plan.closing_rest_s = check_end_s;
  const double fast_dps =
      std::floor(std::min({check_fast_dps, speed_limit_dps(servo), stroke_deg(servo) / check_sweep_s}));
  const double slow_dps = std::min(check_slow_dps, check_slow_share * fast_dps);
  const double two_legs_deg =
      leg_travel_deg(slow_dps, 2 * plan.frames_per_leg, camera.output_rate_hz, servo.acceleration_dps2);
  if (slow_dps == check_slow_dps && two_legs_deg <= stroke_deg(servo))
    plan.leg_rates_dps = {slow_dps, slow_dps, -slow_dps, -slow_dps};
  else
    plan.leg_rates_dps = {slow_dps, -slow_dps};
  plan.leg_rates_dps.insert(plan.leg_rates_dps.end(), {fast_dps, -fast_dps});
  return plan;
}

}  // namespace

SweepPlan reversals_plan(const std::string& name, std::span<const double> shares, double fastest_dps,
                         int frames_per_leg, const ServoProfile& servo, const CameraProfile& camera) {
  SweepPlan plan = moving_plan(name, frames_per_leg);
  add_reversals(2 * static_cast<int>(shares.size()),
                speed_within_stroke(fastest_dps, frames_per_leg, servo, camera), shares, plan);
  return plan;
}

SweepPlan calibration_plan(CalibrationKind kind, const ServoProfile& servo, const CameraProfile& camera) {
  switch (kind) {
    case CalibrationKind::latency:
      return latency_plan(servo, camera);
    case CalibrationKind::orientation:
      return orientation_plan(servo, camera);
    case CalibrationKind::scale:
      return scale_plan(servo, camera);
    case CalibrationKind::lens:
      return lens_plan(servo, camera);
    case CalibrationKind::check:
      return check_plan_of(servo, camera);
    case CalibrationKind::encoder:
      return encoder_plan(servo, camera);
    case CalibrationKind::bias:
      break;
  }
  return resting_plan("calibrate-bias");
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

// What a plan will bring, before anything moves. A window is a run of frames that are all valid; it needs
// constant speed for the exposure of its first frame and a period for each further one, after the servo has
// settled. Two answers: what is certain keeps the profile's guard (`settle_s`) after each change of speed;
// what is expected lets the servo's loop settle as its `loop_hz` says. Where within its period the camera is
// when a ramp ends is not known: expected numbers are means over that.

inline constexpr int window_frames_max = 6;

/// Time at constant speed that is certain to hold one window of `frames` frames.
double window_s(int frames, const ServoProfile& servo, double frame_rate_hz);

/// The same as travel between the stops, with the two ramps.
double window_travel_deg(double rate_dps, int frames, const ServoProfile& servo, double frame_rate_hz);

/// Time at constant speed of one sweep from stop to stop; infinite for a continuous servo.
double sweep_constant_s(double rate_dps, const ServoProfile& servo);

/// How long after a ramp the shaft is expected to differ from the command by more than a valid frame may.
double settling_s(double rate_dps, const ServoProfile& servo);

/// How a leg goes: a ramp, then constant speed up to its end or, back and forth, with reversals in between.
struct LegCourse {
  double ramp_s = 0.0;
  double settling_s = 0.0;  // after each change of speed
  double constant_s = 0.0;  // of each sweep; infinite where the servo does not turn back
  double reversal_s = 0.0;
  bool turns_back() const;
};

/// Windows of `frames` frames within `constant_s` of constant speed, `settling_s` of it lost; 0 if none fits.
double windows_within(double constant_s, double settling_s, int frames, double frame_rate_hz);

/// The course of a leg of `frames` frames at `rate_dps` that follows upon `before_dps` (0: upon rest).
LegCourse leg_course(double rate_dps, double before_dps, double frames, const ServoProfile& servo,
                     double frame_rate_hz);

/// Windows that a leg brings in the direction of its speed, and in the other one.
struct LegYield {
  double own = 0.0;
  double other = 0.0;
};
LegYield leg_yield(const LegCourse& course, double frames, int window_frames, double frame_rate_hz);

/// Camera frames after which a leg has `valid` valid ones in its own direction; infinite if it never has.
double frames_for(double valid, const LegCourse& course, double frame_rate_hz);

/// One leg of a plan as it is expected to go.
struct ExpectedLeg {
  double rate_dps = 0.0;
  LegCourse course;
  double frames = 0.0;  // frames_per_leg, or more where the quota needs them, up to the most a step may have
  double frames_for_quota = 0.0;  // that the quota alone needs, without such a limit; may be infinite
  double transit_s = 0.0;         // to its start, before it
  double duration_s = 0.0;
};

/// From a leg's first command to the next one, once it has had so many frames.
double leg_duration_s(double frames, double frame_rate_hz);

/// All of them, in driving order. A leg that goes back and forth also fills the quota of the other direction.
std::vector<ExpectedLeg> expected_legs(const SweepPlan& plan, const ServoProfile& servo,
                                       double frame_rate_hz);

/// However few valid frames come, a step of a plan is never driven for more than this many times its frames.
inline constexpr int frames_growth_max = 20;

/// What one speed of a plan brings.
struct SpeedYield {
  double rate_dps = 0.0;  // magnitude
  struct Windows {
    double sweep = 0.0;       // in one sweep from stop to stop; infinite for a continuous servo
    double leg = 0.0;         // in one leg, in both directions
    double travel_deg = 0.0;  // that is certain to hold one such window, ramps included
    bool possible = true;     // with this servo's travel
  };
  std::array<Windows, window_frames_max> windows;  // of 1, 2, ... frames
  double duration_s = 0.0;                         // of its legs, both directions, with their transits
};

/// Ascending by speed.
std::vector<SpeedYield> plan_yield(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz);

}  // namespace thermorig::rig

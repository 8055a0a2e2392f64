// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"

namespace thermorig::rig {

/// The longest that a recording without a servo lasts, in s.
inline constexpr double longest_by_hand_s = 86400.0;

/// What an acquisition drives: a rest, legs of constant commanded speed, a rest. docs/sweep_plans.md.
struct SweepPlan {
  std::string name;
  std::vector<double> leg_rates_dps;  // signed, in driving order
  int frames_per_leg = 57;            // camera frames from a leg's first to its last, flagged ones included
  int valid_per_leg = 0;              // valid frames that each leg must bring; 0: whatever its frames give
  bool repeat = false;                // begins again after its last leg, until it is stopped
  std::uint16_t last_leg = 65535;     // the run ends after the leg of this number: no two have the same
  bool for_calibration = false;       // legs may be too short for a valid frame, and there may be none
  double opening_rest_s = 10.0;
  double closing_rest_s = 10.0;
  std::uint64_t seed = 1;  // of the order of the magnitudes

  /// Of by_hand_plan() without seconds.
  bool ends_by_stop() const { return leg_rates_dps.empty() && opening_rest_s >= longest_by_hand_s; }
};

/// What the command line changes in a plan; unset members leave it as it is.
struct PlanOverrides {
  std::vector<double> magnitudes_dps;  // empty: the plan's own; else driven as +v, -v in the plan's order
  std::optional<int> frames_per_leg;
  std::optional<int> valid_per_leg;
  std::optional<double> opening_rest_s;
  std::optional<double> closing_rest_s;
  std::optional<std::uint64_t> seed;
};

/// Names of the built-in plans: "paper", "table-one", "quick".
const std::vector<std::string>& built_in_plan_names();

/// A built-in plan by its name, or a TOML file by its path, with the overrides applied. `environment` matters
/// to "table-one" only (51 frames a speed in "garden", 61 elsewhere). `seed` orders the magnitudes unless
/// the file or the overrides say otherwise. Throws Error(bad_usage).
SweepPlan load_plan(const std::string& name_or_file, const std::string& environment, std::uint64_t seed,
                    const PlanOverrides& overrides = {});

/// The plan of a rig without a servo: no legs, so many seconds in all. None: until it is stopped, a day at
/// most.
SweepPlan by_hand_plan(std::optional<double> seconds);

/// A plan from TOML text: `magnitudes_dps = [..]` or `min_dps`, `max_dps`, `step_dps`; `order` ("seeded",
/// "ascending", "descending", "given"), `both_directions`, `frames_per_leg`, `valid_per_leg`,
/// `opening_rest_s`, `closing_rest_s`, `seed`, `name`. Throws Error(bad_usage) with file and line.
SweepPlan parse_plan(const std::string& text, const std::string& file_name, std::uint64_t seed,
                     const PlanOverrides& overrides = {});

/// Valid frames that a leg of so many camera frames must bring where the plan does not say: 50, or what a
/// shorter leg of the default rig surely gives.
int default_valid_per_leg(int frames_per_leg);

/// The plan as TOML: every leg's speed, in order. parse_plan() gives the same legs back.
std::string to_toml(const SweepPlan& plan);

/// What a calibration is recorded for.
enum class CalibrationKind : std::uint8_t { bias, latency, scale, orientation, lens, check, encoder };

/// The plan that shows what the calibration needs, on this rig: `bias` a rest of 60 s; `latency` a minute of
/// reversals every 2 s at up to 120 deg/s; `orientation` twelve slow sweeps; `scale` 420 degrees forth and
/// back at 40 deg/s, three times, or, where the servo has less travel, a rest of 60 s in which the rig is
/// turned by hand; `lens` three minutes of sweeps there and back at 40 and 60 deg/s, more than a whole turn
/// each where the servo has the travel; `encoder` twelve legs there and back at 100 to 200 deg/s, or more and
/// shorter ones; `check` less than half a minute: a rest, two speeds in both directions, and a whole turn
/// where the servo has the travel.
SweepPlan calibration_plan(CalibrationKind kind, const ServoProfile& servo, const CameraProfile& camera);

/// A plan for a calibration: there and back at each of `shares` of `fastest_dps`, or of what the travel lets
/// legs of so many frames go at.
SweepPlan reversals_plan(const std::string& name, std::span<const double> shares, double fastest_dps,
                         int frames_per_leg, const ServoProfile& servo, const CameraProfile& camera);

/// Can this rig drive the plan, and give at least one valid window of `window_frames` frames in every leg?
/// Throws Error(bad_usage) that shows the sum: speeds beyond the servo's limits, legs or sweeps too short, a
/// frame rate that the baud cannot carry.
void check_plan(const SweepPlan& plan, const ServoProfile& servo, const CameraProfile& camera,
                int window_frames = 1);

/// Angle that a leg of `frames` frames at `rate_dps` covers at `frame_rate_hz`, ramps and reaction included.
double leg_travel_deg(double rate_dps, double frames, double frame_rate_hz, double acceleration_dps2);

/// The fastest that this servo may be driven at: by its profile and by the firmware.
double speed_limit_dps(const ServoProfile& servo);

/// Half of the angle that the servo may use around its middle; nothing for a continuous servo.
std::optional<double> angle_limit_deg(const ServoProfile& servo);

/// From one end of the travel to the other; infinite for a continuous servo.
double stroke_deg(const ServoProfile& servo);

/// The direction of a speed: -1 or 1.
inline double sign_of(double rate_dps) {
  return rate_dps < 0.0 ? -1.0 : 1.0;
}

/// About how long the plan takes on this rig, transits and rests included.
double plan_duration_s(const SweepPlan& plan, const ServoProfile& servo, double frame_rate_hz);

/// What a device sends all the time.
struct LinkLoad {
  std::uint64_t message_bytes = 0;  // of one frame, sample or telemetry message, at most
  double rate_hz = 0.0;             // messages a second, nominal
  double bytes_per_s() const { return static_cast<double>(message_bytes) * rate_hz; }
};

LinkLoad link_load(Device device, const RigProfile& profile);

/// Bytes that the journal of the whole plan will need, generously.
std::uint64_t expected_journal_bytes(const SweepPlan& plan, const RigProfile& profile);

/// What a session needs beside the journal that it is made of, bytes.
std::uint64_t session_bytes_beside(std::uint64_t journal_bytes);

/// Both: a disk with less is refused before anything moves.
std::uint64_t expected_recording_bytes(const SweepPlan& plan, const RigProfile& profile);

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

/// The angle that a servo has to drive legs in, to both sides of its middle. Infinite for a continuous servo
/// without a cable.
class ServoTravel {
 public:
  explicit ServoTravel(const ServoProfile& servo)
      : acceleration_dps2_(servo.acceleration_dps2), stroke_deg_(stroke_deg(servo)) {}

  /// A leg of so many frames is longer than from end to end: it must turn back.
  bool is_too_short_for(double rate_dps, double frames, double frame_rate_hz) const {
    return leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_) > stroke_deg_;
  }

  /// What such a leg covers, at most from end to end.
  double way_deg(double rate_dps, double frames, double frame_rate_hz) const {
    return std::min(leg_travel_deg(rate_dps, frames, frame_rate_hz, acceleration_dps2_), stroke_deg_);
  }

  /// Where a leg begins that lies even about the middle.
  static double start_deg(double rate_dps, double way_deg) { return -sign_of(rate_dps) * way_deg / 2.0; }

  /// Does a leg that begins here end before the end of the travel, or so little beyond it?
  bool has_room(double rate_dps, double way_deg, double from_deg, double beyond_deg = 0.0) const {
    return sign_of(rate_dps) * from_deg + way_deg <= stroke_deg_ / 2.0 + beyond_deg;
  }

  /// Camera frames at this speed before the servo must brake for its end, at most so many.
  int frames_left(double rate_dps, double from_deg, double frame_rate_hz, int most) const {
    constexpr double command_delay_s = 0.25;  // from here to the servo's next command
    const double speed_dps = std::abs(rate_dps);
    const double room_deg =
        stroke_deg_ / 2.0 - sign_of(rate_dps) * from_deg - speed_dps * speed_dps / (2.0 * acceleration_dps2_);
    const double frames = (room_deg / speed_dps - command_delay_s) * frame_rate_hz;
    return static_cast<int>(std::clamp(frames - 1.0, 0.0, static_cast<double>(most)));
  }

 private:
  double acceleration_dps2_;
  double stroke_deg_;  // from end to end
};

}  // namespace thermorig::rig

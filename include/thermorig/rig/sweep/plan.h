// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

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
enum class CalibrationKind : std::uint8_t { bias, latency, scale, orientation, lens, check };

/// The plan that shows what the calibration needs, on this rig: `bias` a rest of 60 s; `latency` a minute of
/// reversals every 2 s at up to 120 deg/s; `orientation` twelve slow sweeps; `scale` 420 degrees forth and
/// back at 40 deg/s, three times, or, where the servo has less travel, a rest of 60 s in which the rig is
/// turned by hand; `lens` three minutes of sweeps there and back at 40 and 60 deg/s, more than a whole turn
/// each where the servo has the travel; `check` less than half a minute: a rest, two speeds in both
/// directions, and a whole turn where the servo has the travel.
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

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace thermorig::simulation {

// What the devices of a simulated rig do beyond what a careful owner expects of them. Each number is a knob:
// docs/worlds.md says what it does, its unit, its range and where that comes from. The values here are those
// of the honest world; a knob that has its honest value changes no bit of what the rig sends.

/// The servo, from the pulse to the shaft.
struct ServoWorld {
  double damping = 0.7;
  double backlash_deg = 0.0;
  double stick_deg = 0.0;
  double cold_friction_deg = 0.0;
  double dead_band_deg = 0.0;
  double load_deg = 0.0;
  double ripple = 0.0;
  double ripple_period_deg = 30.0;
  double top_speed_dps = 600.0;
  double supply_sag = 0.0;
};

/// The clock of the servo's micro-controller.
struct ServoClockWorld {
  double error_ppm = 0.0;
  double warm_up_ppm = 0.0;
  double wave_ppm = 0.0;
  double wave_period_s = 300.0;
};

/// Serial lines, USB, and the host's reading and clock.
struct LinksWorld {
  double baud_error = 0.0;
  double hub_delay_ms = 0.0;
  double hub_jitter_ms = 0.0;
  double stall_ms = 0.0;
  double stall_interval_s = 3.0;
  double frame_jitter_ms = 0.0;
  double read_delay_ms = 0.0;
  double host_slew_ppm = 0.0;
};

struct GyroWorld {
  double bandwidth_hz = 256.0;
  double cross_axis = 0.0;
  double g_sensitivity_dps = 0.0;
  double self_heating_k = 0.0;
  double self_heating_s = 120.0;
  double bias_per_k_dps = 0.0;
  double scale_per_k = 0.0;
  double scale_change = 0.0;
  double vibration_dps = 0.0;
  double zero_below_dps = 0.0;
  double unit = 1.0;
  double mounted_deg = 0.0;
};

struct CameraWorld {
  double rolling_rows = 0.0;
  double lost_subpages = 0.0;
  double repeated_frames = 0.0;
  double membrane_lag_ms = 12.0;
  double extra_latency_ms = 0.0;
  double tilt_deg = 0.0;
  double roll_deg = 0.0;
  double lever_arm_m = 0.0;
  double pitch_error = 0.0;
  double distortion = 0.0;
  double warm_up_k = 0.0;
  double dead_pixels = 0.0;
  double turned_over = 0.0;
};

/// An AS5600 on the shaft, if the rig has one.
struct EncoderWorld {
  double once_deg = 0.3;
  double twice_deg = 0.1;
  double failed_reads = 0.0;
  double weak_magnet = 0.0;
};

/// What stands, walks and shines around the rig.
struct SceneWorld {
  double distance_m = 3.0;
  double person_dps = 0.0;
  double pet_dps = 0.0;
  double sun_k = 0.0;
  double contrast = 1.0;
  double saturation_c = 300.0;
};

struct World {
  std::string name = "honest";  // the one that it began as
  ServoWorld servo;
  ServoClockWorld clock;
  LinksWorld links;
  GyroWorld gyro;
  CameraWorld camera;
  EncoderWorld encoder;
  SceneWorld scene;
};

/// The one that a simulated rig has if nobody chose.
inline constexpr std::string_view default_world = "typical";

/// The world of a text such as `honest`, `typical` or `hard,gyro.bandwidth_hz=20`. In `typical` every knob is
/// drawn, by a stream of its own of the seed, from the middle third of its range, and each effect that comes
/// by chance comes in one of ten; in `hard` from the whole range, and in every second. Naming a knob changes
/// no other. Throws Error(bad_usage) for a world or knob that there is not, and for a value out of its range.
World world_named(std::string_view text, std::uint64_t seed);

/// The world as world_named() takes it: its name and every knob that is not honest. It gives the same world
/// again, whatever the seed.
std::string text_of(const World& world);

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include "chosen_rig.h"

#include <array>

#include "profile_path.h"
#include "thermorig/core/error.h"
#include "thermorig/io/port.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/simulation/panorama.h"
#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::app {

namespace {

bool names_a_port(const RigOptions& options) {
  for (Device device : all_devices)
    if (!options.ports[device].empty()) return true;
  return false;
}

void check_words(const RigOptions& options) {
  const bool simulated = options.simulated_seed.has_value();
  if (simulated && names_a_port(options))
    throw Error(ExitCode::bad_usage, "--simulated and ports exclude each other", "",
                "--simulated alone, or --camera, --gyro and --servo");
  const SimulatedParts& parts = options.parts;
  if (!simulated && (parts.servo || parts.camera || parts.gyro || parts.gyro_protocol || parts.encoder ||
                     parts.scene || parts.world))
    throw Error(ExitCode::bad_usage,
                "--simulated-servo, --simulated-camera, --simulated-gyro, --simulated-gyro-protocol, "
                "--simulated-encoder, --scene and --world need --simulated",
                "", "--simulated=4");
}

void check_servo_words(const RigOptions& options) {
  if (!options.no_servo || (options.ports[Device::servo].empty() && !options.parts.servo)) return;
  throw Error(ExitCode::bad_usage, "--no-servo says that there is no servo, and another word names one", "",
              "leave --no-servo out, or --servo and --simulated-servo");
}

void check_ports(const RigProfile& profile, const PerDevice<bool>& needed) {
  std::string missing;
  for (Device device : all_devices)
    if (needed[device] && profile.has(device) && profile.link(device).port.empty())
      missing += (missing.empty() ? "" : ", ") + std::string(name_of(device));
  if (missing.empty()) return;
  throw Error(ExitCode::bad_usage, "no port is given for " + missing, "",
              "thermorig ports (finds them), --rig PROFILE, or --simulated; --no-servo without a servo");
}

/// The device behind a port's name; the name itself if there is none, which opening it will say.
std::string device_behind(const std::string& port) {
  try {
    return io::resolve_port(port);
  } catch (const Error&) {
    return port;
  }
}

void check_ports_differ(const RigProfile& profile) {
  for (std::size_t i = 0; i < device_count; ++i)
    for (std::size_t k = i + 1; k < device_count; ++k) {
      const std::string& one = profile.link(all_devices[i]).port;
      if (one.empty() || device_behind(one) != device_behind(profile.link(all_devices[k]).port)) continue;
      throw Error(ExitCode::bad_usage,
                  "the same port is named for " + std::string(name_of(all_devices[i])) + " and " +
                      std::string(name_of(all_devices[k])),
                  one, "thermorig ports (shows which device is on which port)");
    }
}

void apply(const RigOptions& options, RigProfile& profile) {
  if (!options.gyro_protocol.empty()) sensors::choose_gyro(options.gyro_protocol, profile.gyro);
  if (!options.servo_protocol.empty()) sensors::choose_servo(options.servo_protocol, profile.servo);
  for (Device device : all_devices)
    if (!options.ports[device].empty()) profile.link(device).port = options.ports[device];
  if (io::is_i2c_bus(options.ports[Device::camera])) {  // which has no other protocol and no baud rate
    profile.camera.protocol = "mlx-raw";
    profile.camera.link.baud = 0;
  }
  if (options.camera_baud) profile.camera.link.baud = *options.camera_baud;
  if (options.gyro_baud) profile.gyro.link.baud = *options.gyro_baud;
  if (options.servo_baud) profile.servo.link.baud = *options.servo_baud;
  if (options.no_servo) profile.servo.kind = ServoKind::none;
  if (options.camera_rate_hz) profile.camera.output_rate_hz = *options.camera_rate_hz;
}

/// Of the file each value was looked at as it was read: what is wrong now is an option's.
void check_values(const RigProfile& profile) {
  if (const auto problem = recording_header::problem_of(profile))
    throw Error(ExitCode::bad_usage, problem->what,
                problem->table.empty() ? "the rig's options" : "the " + problem->table + "'s options",
                problem->allowed);
}

ServoProfile simulated_servo(const std::string& kind, ServoProfile servo) {
  if (kind == "winch") return servo;
  if (kind == "continuous") {
    servo.model = "continuous";
    servo.kind = ServoKind::continuous;
    servo.travel_deg = 0;
    servo.full_rate_dps = 300;
    return servo;
  }
  if (kind == "dynamixel") {
    sensors::choose_servo("dynamixel", servo);
    servo.model = "Dynamixel XL330, 6 turns of cable";
    servo.link.baud = 1'000'000;
    return servo;
  }
  if (kind == "sts3215") {
    sensors::choose_servo("sts3215", servo);
    servo.model = "Feetech STS3215, 6 turns of cable";
    return servo;
  }
  if (kind == "grbl") {
    sensors::choose_servo("grbl", servo);
    servo.model = "stepper, GRBL 1.1, 6 turns of cable";
    return servo;
  }
  servo.model = "positional, " + kind + " degrees";
  servo.travel_deg = kind == "180" ? 180 : 270;
  return servo;
}

simulation::GyroGrade gyro_grade(const std::string& name) {
  if (name == "calibrated") return simulation::GyroGrade::calibrated;
  return name == "raw" ? simulation::GyroGrade::mpu6050_raw : simulation::GyroGrade::typical;
}

}  // namespace

simulation::VirtualRigConfig simulated_rig(std::uint64_t seed, const std::string& environment,
                                           const SimulatedParts& parts) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, environment);
  config.profile.servo = simulated_servo(parts.servo.value_or("winch"), config.profile.servo);
  if (parts.gyro_protocol) sensors::choose_gyro(*parts.gyro_protocol, config.profile.gyro);
  config.has_encoder = parts.encoder.value_or("none") == "as5600";
  config.gyro_grade = gyro_grade(parts.gyro.value_or("typical"));
  config.scene = parts.scene.value_or(simulation::scene_of(environment));
  simulation::put_in_world(
      simulation::world_named(parts.world.value_or(std::string(simulation::default_world)), seed), config);
  simulation::choose_camera(parts.camera.value_or("half"), config);
  return config;
}

void turn_by_hand(ChosenRig& rig, HostTime start, double seconds) {
  constexpr double rest_before_s = 12.0, rest_behind_s = 8.0, pause_s = 1.0;
  constexpr std::array<double, 4> durations_s{12.0, 8.0, 6.0, 4.0};  // of each turn and its way back
  constexpr double turn_deg = 420.0;
  double at_s = rest_before_s;
  for (std::size_t turn = 0;; ++turn) {
    const double duration_s = durations_s[turn / 2 % durations_s.size()];
    if (at_s + duration_s > seconds - rest_behind_s) return;
    rig.simulated->hand_turns.push_back({.begin = start + from_s(at_s),
                                         .duration_s = duration_s,
                                         .angle_deg = turn % 2 == 0 ? turn_deg : -turn_deg});
    at_s += duration_s + pause_s;
  }
}

ChosenRig chosen_rig(const RigOptions& options, const std::string& environment,
                     const PerDevice<bool>& needed) {
  check_words(options);
  check_servo_words(options);
  ChosenRig chosen;
  if (options.simulated_seed) {
    chosen.simulated = simulated_rig(*options.simulated_seed, environment, options.parts);
    chosen.profile = chosen.simulated->profile;
  }
  if (!options.profile.empty()) chosen.profile = read_named_profile(options.profile);
  apply(options, chosen.profile);
  check_values(chosen.profile);
  if (chosen.simulated) {
    chosen.simulated->profile = chosen.profile;
    // The simulated rig has one in any case, which then stands still: a hand turns all of it.
    if (!chosen.profile.servo.is_there()) chosen.simulated->profile.servo = ServoProfile();
  } else {
    check_ports(chosen.profile, needed);
    check_ports_differ(chosen.profile);
  }
  return chosen;
}

}  // namespace thermorig::app

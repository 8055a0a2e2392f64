// SPDX-License-Identifier: MIT
#include "rig_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <utility>

#include "help_formatter.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/simulation/panorama.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::app {

namespace {
std::optional<std::uint64_t> seed_of(const std::string& text) {
  std::uint64_t seed = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, seed);
  return error == std::errc() && at == end ? std::optional(seed) : std::nullopt;
}

std::string problem_of_seed(const std::string& text) {
  return seed_of(text) ? "" : "the seed '" + text + "' is not a whole number from 0 to 2^64 - 1";
}
}  // namespace

CLI::Validator within(double least, double most) {
  return {[=](const std::string& text) {
            double value = 0.0;
            const bool is_within = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return is_within ? ""
                             : fmt::format("{} is not a number from {:.10g} to {:.10g}", text, least, most);
          },
          ""};
}

void add_json(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "Print JSON, for programs")->group(last_group);
}

void add_sync(CLI::App& command, int& period_ms) {
  command.add_option("--sync", period_ms, "Milliseconds of data that a power cut may cost (10 to 60000)")
      ->check(CLI::Validator(
          [](const std::string& word) {
            return word == "frame" || word == "end" ? word +
                                                          " is no longer a value: --sync takes milliseconds, "
                                                          "10 to 60000 (125 is the default)"
                                                    : "";
          },
          ""))
      ->check(within(10, 60'000))
      ->type_name("MS")
      ->capture_default_str();
}

void add_replug(CLI::App& command, double& patience_s) {
  command
      .add_option("--replug-patience", patience_s,
                  "Seconds to wait for an unplugged device (0: stop at once)")
      ->check(within(0.0, 86400.0))
      ->type_name("SECONDS")
      ->capture_default_str();
}

CLI::Validator known_name(std::vector<std::string> names) {
  return {[names = std::move(names)](const std::string& name) {
            if (std::find(names.begin(), names.end(), name) != names.end()) return std::string();
            return fmt::format("\"{}\" is not known: {}", name, advice_on_name(name, names));
          },
          ""};
}

CLI::Validator one_of(std::vector<std::string> names) {
  std::string listed = fmt::format("{{{}}}", fmt::join(names, ","));
  CLI::Validator validator = known_name(std::move(names));
  validator.description(std::move(listed));
  return validator;
}

CLI::Validator not_negative() {
  return {[](const std::string& number) {
            return number.starts_with('-') ? number + " is negative" : std::string();
          },
          ""};
}

void add_simulated_parts(CLI::App& command, SimulatedParts& parts) {
  command
      .add_option("--simulated-servo", parts.servo,
                  "Servo: winch (6 turns, default), 180, 270 (degrees), continuous, dynamixel, grbl, sts3215")
      ->check(one_of({"winch", "180", "270", "continuous", "dynamixel", "grbl", "sts3215"}))
      ->type_name("KIND");
  command
      .add_option(
          "--simulated-camera", parts.camera,
          "Camera: half (half of the pixels are new in each frame, default), full (all are), query (as "
          "half, sends a frame when asked), text or binary (full, as sketches send it), raw (half, the "
          "sensor's own words through a stick), i2c (the same on a bus of the computer)")
      ->check(one_of({simulation::camera_kinds().begin(), simulation::camera_kinds().end()}))
      ->type_name("KIND");
  command
      .add_option("--simulated-gyro", parts.gyro,
                  "Bias of the gyro: typical (about 2 deg/s, default), calibrated (0.1), raw (10)")
      ->check(one_of({"calibrated", "typical", "raw"}))
      ->type_name("KIND");
  command
      .add_option(
          "--simulated-gyro-protocol", parts.gyro_protocol,
          "What the simulated gyro speaks, at its usual rate (default witmotion): vectornav, text, ...")
      ->check(known_name(sensors::gyro_names()))
      ->type_name("NAME");
  command.add_option("--simulated-encoder", parts.encoder, "What measures the shaft: none (default), as5600")
      ->check(one_of({"none", "as5600"}))
      ->type_name("KIND");
  command
      .add_option("--scene", parts.scene,
                  "What the camera sees (default: the scene named like the environment, else laboratory)")
      ->check(one_of(simulation::scene_names()))
      ->type_name("NAME");
  command
      .add_option("--world", parts.world,
                  "How many faults the rig has: honest (few), typical (default), hard; each can be changed: "
                  "hard,gyro.bandwidth_hz=20")
      ->type_name("WORLD");
}

void add_seed(CLI::App& command, std::function<void(std::uint64_t)> take, const std::string& meaning) {
  command.add_flag("--simulated{1}", meaning)
      ->check(CLI::Validator(problem_of_seed, ""))
      ->each([take = std::move(take)](const std::string& text) { take(seed_of(text).value()); })
      ->type_name("SEED");
}

CLI::Option& add_environment(CLI::App& command, std::string& environment) {
  return *command
              .add_option("-e,--environment", environment,
                          "Where the rig stands, e.g. garden: a-z, 0-9 and '-', at most 32 characters")
              ->type_name("NAME");
}

void add_plan(CLI::App& command, RecordOptions& record) {
  command
      .add_option("--plan", record.plan,
                  "Sweep plan: quick (30 s), paper (50 legs of 57 frames), table-one, or a TOML file")
      ->each([&record](const std::string&) { record.plan_is_named = true; })
      ->type_name("PLAN")
      ->capture_default_str();
}

void add_legs(CLI::App& command, RecordOptions& record, const std::string& quota) {
  command
      .add_option("--frames-per-leg", record.frames_per_leg,
                  "Camera frames in each leg (default: the plan's)")
      ->type_name("N");
  command
      .add_option(
          "--valid-per-leg", record.valid_per_leg,
          "Valid frames that each leg needs; it is driven until it has them (0: do not wait; default: " +
              quota + ")")
      ->type_name("N");
  command
      .add_option("--speeds", record.speeds_dps,
                  "Speeds in deg/s, each driven in both directions: 30,60,90 (default: the plan's)")
      ->delimiter(',')
      ->type_name("V,V,...");
}

void add_seconds(CLI::App& command, RecordOptions& record) {
  command
      .add_option("--seconds", record.seconds,
                  "Without a servo: seconds to record, 10 to 86400 (default: until Ctrl-C)")
      ->check(within(10.0, 86400.0))
      ->type_name("S");
}

void add_folder(CLI::App& command, std::filesystem::path& folder, const std::string& meaning) {
  command.add_option("-o,--output", folder, meaning)->type_name("DIR")->default_str("recordings");
}

void add_rig(CLI::App& command, RigOptions& rig) {
  in_group(command, rig_group, [&] {
    add_seed(
        command, [&rig](std::uint64_t seed) { rig.simulated_seed = seed; },
        "Use the simulated rig; another SEED is another rig (default 1)");
    command
        .add_option(
            "--rig", rig.profile,
            "Profile of the rig (from `thermorig ports --save`): a name, or a file that ends in .toml or has "
            "a '/' in it")
        ->type_name("PROFILE");
    command
        .add_option("--camera", rig.ports[Device::camera],
                    "Port of the camera, e.g. /dev/ttyUSB0 (default: the profile's)")
        ->type_name("PORT");
    command.add_option("--gyro", rig.ports[Device::gyro], "Port of the gyro (default: the profile's)")
        ->type_name("PORT");
    command
        .add_option("--servo", rig.ports[Device::servo], "Port of the servo board (default: the profile's)")
        ->type_name("PORT");
    command.add_flag("--no-servo", rig.no_servo,
                     "No servo turns the rig, but e.g. a hand; labels are made from the gyro");
    command
        .add_option(
            "--gyro-protocol", rig.gyro_protocol,
            "What the gyro speaks, or the sketch whose lines it prints, at its usual rate: vectornav, "
            "adafruit-mpu6050, ... (default: the profile's)")
        ->check(known_name(sensors::gyro_names()))
        ->type_name("NAME");
    command
        .add_option("--servo-protocol", rig.servo_protocol,
                    "What the servo speaks: servo-link (a board with this program's firmware), dynamixel, "
                    "grbl or sts3215, at its usual baud rate (default: the profile's)")
        ->check(known_name(sensors::servo_protocol_names()))
        ->type_name("NAME");
    command.add_option("--camera-baud", rig.camera_baud, "Baud rate of the camera (default: the profile's)")
        ->type_name("N");
    command.add_option("--gyro-baud", rig.gyro_baud, "Baud rate of the gyro (default: the profile's)")
        ->type_name("N");
    command
        .add_option("--servo-baud", rig.servo_baud, "Baud rate of the servo board (default: the profile's)")
        ->type_name("N");
    command
        .add_option(
            "--camera-rate", rig.camera_rate_hz,
            "Frames per second; the camera is asked for them (GY-MCU90640: 0.5, 1, 2, 4 or 8; default: the "
            "profile's)")
        ->type_name("HZ");
  });
  in_group(command, simulated_rig_group, [&] { add_simulated_parts(command, rig.parts); });
}

}  // namespace thermorig::app

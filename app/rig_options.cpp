// SPDX-License-Identifier: MIT
#include "rig_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/simulation/panorama.h"

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
/// CLI::Range takes NaN for a number of any range.
CLI::Validator within(double least, double most) {
  return {[=](const std::string& text) {
            double value = 0.0;
            const bool is_within = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return is_within ? "" : fmt::format("{} is not a number from {} to {}", text, least, most);
          },
          ""};
}
}  // namespace

void add_json(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "Print JSON on standard output, for programs");
}

void add_sync(CLI::App& command, std::string& sync) {
  command
      .add_option(
          "--sync", sync,
          "When the disk must have it: frame (each), end, or so many ms that a loss of power costs at most")
      ->type_name("WHEN")
      ->capture_default_str();
}

void add_replug(CLI::App& command, double& patience_s) {
  command
      .add_option("--replug-patience", patience_s,
                  "A device that goes during the run is waited for so long (0: the end at once)")
      ->check(within(0.0, 86400.0))
      ->type_name("SECONDS")
      ->capture_default_str();
}

CLI::Validator one_of(std::vector<std::string> names) {
  std::string listed = fmt::format("{{{}}}", fmt::join(names, ","));
  const auto problem = [names = std::move(names)](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) != names.end()) return std::string();
    return fmt::format("\"{}\" is not known: {}", name, advice_on_name(name, names));
  };
  return {problem, std::move(listed)};
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
                  "Servo of the simulated rig: winch (default), 180, 270, continuous")
      ->check(CLI::IsMember({"winch", "180", "270", "continuous"}))
      ->type_name("KIND");
  command
      .add_option(
          "--simulated-camera", parts.camera,
          "Fresh chess halves in a simulated frame: half (default), full; query: half, and it waits to be "
          "asked for frames; text, binary: full, as a sketch sends them")
      ->check(CLI::IsMember({"half", "full", "query", "text", "binary"}))
      ->type_name("KIND");
  command
      .add_option("--simulated-gyro", parts.gyro,
                  "Bias, scale and noise of the simulated gyro: calibrated, typical (default), raw")
      ->check(CLI::IsMember({"calibrated", "typical", "raw"}))
      ->type_name("KIND");
  command
      .add_option("--scene", parts.scene,
                  "What the simulated camera sees (default: the environment's, else laboratory)")
      ->check(one_of(simulation::scene_names()))
      ->type_name("NAME");
  command
      .add_option("--world", parts.world,
                  "How hard the simulated rig makes it: honest, typical (default), hard; with knobs of it: "
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
                          "Where the rig stands: a-z, 0-9 and '-', e.g. garden")
              ->type_name("NAME");
}

void add_legs(CLI::App& command, RecordOptions& record, const std::string& quota) {
  command.add_option("--frames-per-leg", record.frames_per_leg, "Camera frames in each leg of the plan")
      ->type_name("N");
  command
      .add_option("--valid-per-leg", record.valid_per_leg, "Valid frames that each leg must bring" + quota)
      ->type_name("N");
  command
      .add_option("--speeds", record.speeds_dps,
                  "Magnitudes to sweep, deg/s, each driven as +v and -v: 30,60,90")
      ->delimiter(',')
      ->type_name("V,V,...");
}

void add_plan(CLI::App& command, RecordOptions& record, const std::string& meaning) {
  command.add_option("--plan", record.plan, meaning)
      ->each([&record](const std::string&) { record.plan_is_named = true; })
      ->type_name("PLAN")
      ->capture_default_str();
}

void add_seconds(CLI::App& command, RecordOptions& record) {
  command
      .add_option("--seconds", record.seconds,
                  "Without a servo: end after so long, 10 to 86400 (default: Ctrl-C ends it)")
      ->check(within(10.0, 86400.0))
      ->type_name("S");
}

void add_folder(CLI::App& command, std::filesystem::path& folder, const std::string& meaning) {
  command.add_option("-o,--output", folder, meaning)->type_name("DIR")->default_str("recordings");
}

void add_rig(CLI::App& command, RigOptions& rig) {
  add_seed(
      command, [&rig](std::uint64_t seed) { rig.simulated_seed = seed; },
      "Use the simulated rig; =SEED chooses another world (default 1)");
  command.add_option("--camera", rig.ports[Device::camera], "Port of the camera, e.g. /dev/ttyUSB0")
      ->type_name("PORT");
  command.add_option("--gyro", rig.ports[Device::gyro], "Port of the gyro")->type_name("PORT");
  command.add_option("--servo", rig.ports[Device::servo], "Port of the servo's micro-controller")
      ->type_name("PORT");
  command.add_flag("--no-servo", rig.no_servo,
                   "Nobody commands what turns the rig, e.g. a hand: labels are the gyro's");
  command
      .add_option("--rig", rig.profile,
                  "Profile that `thermorig ports --save` wrote: a name, or a file (with a '/' in it, or "
                  "ending in .toml)")
      ->type_name("PROFILE");
  command.add_option("--camera-baud", rig.camera_baud, "Baud rate of the camera")->type_name("N");
  command.add_option("--gyro-baud", rig.gyro_baud, "Baud rate of the gyro")->type_name("N");
  command.add_option("--servo-baud", rig.servo_baud, "Baud rate of the servo link")->type_name("N");
  command
      .add_option("--camera-rate", rig.camera_rate_hz,
                  "Frames a second: the camera is asked for them (0.5, 1, 2, 4 or 8 of a GY-MCU90640)")
      ->type_name("HZ");
  add_simulated_parts(command, rig.parts);
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "chosen_rig.h"
#include "commands.h"
#include "interrupts.h"
#include "print/number_json.h"
#include "print/output.h"
#include "print/simulation_text.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::app {

namespace {

RigProfile profile_of(const simulation::VirtualRigConfig& config, const PerDevice<std::string>& paths) {
  RigProfile profile = config.profile;
  profile.name = "simulated";
  for (Device device : all_devices) profile.link(device).port = paths[device];
  return profile;
}

void announce(const SimulateOptions& options, const simulation::VirtualRigConfig& config,
              const SimulatedPorts& ports) {
  const std::string& scene = config.scene;
  const std::string world = simulation::text_of(config.world);
  const auto& paths = ports.paths();
  if (options.json) {
    nlohmann::json object{
        {"event", "ready"}, {"seed", options.seed}, {"environment", options.environment},
        {"scene", scene},   {"world", world},       {"firmware", ports.firmware_description()}};
    for (Device device : all_devices) object[std::string(name_of(device))] = paths[device];
    object["profile"] = text_json(options.profile);
    print_json(object);
    return;
  }
  print("SIMULATED rig, {}{}, seed {}, world {}; servo firmware: {}\n\n", printable(options.environment),
        scene == options.environment ? "" : " (scene: " + scene + ")", options.seed, simulation_text(world),
        ports.firmware_description());
  Table table({"role", "port"});
  for (Device device : all_devices) table.add({std::string(name_of(device)), paths[device]});
  print("{}\n", table.text());
  if (!options.profile.empty()) print("profile  {}\n", printable(options.profile));
  const std::string protocol =
      options.parts.gyro_protocol ? " --gyro-protocol " + *options.parts.gyro_protocol : std::string();
  const std::string& servo_protocol = config.profile.servo.protocol;
  const bool has_board = servo_protocol == ServoProfile().protocol;
  print("next  thermorig record --environment {} --camera {} --gyro {}{} --servo {}{}\nCtrl-C ends it\n",
        printable(options.environment), paths[Device::camera], paths[Device::gyro], protocol,
        paths[Device::servo], has_board ? "" : " --servo-protocol " + servo_protocol);
  flush_output();
}

void print_tally(const ServingTally& tally, bool json) {
  if (json) {
    nlohmann::json object{
        {"event", "summary"}, {"elapsed_s", tally.elapsed_s}, {"worst_lag_s", tally.worst_lag_s}};
    for (Device device : all_devices) {
      const PortTally& port = tally.ports[device];
      object["ports"][std::string(name_of(device))] = {{"bytes_delivered", port.bytes_delivered},
                                                       {"bytes_unheard", port.bytes_unheard},
                                                       {"bytes_overrun", port.bytes_overrun},
                                                       {"bytes_received", port.bytes_received}};
    }
    print_json(object);
    return;
  }
  Table table({"role", ">delivered", ">unheard", ">overrun", ">received"});
  for (Device device : all_devices) {
    const PortTally& port = tally.ports[device];
    table.add({std::string(name_of(device)), bytes_text(port.bytes_delivered), bytes_text(port.bytes_unheard),
               bytes_text(port.bytes_overrun), bytes_text(port.bytes_received)});
  }
  print("\n{}", table.text());
}

}  // namespace

ExitCode run(const SimulateOptions& options) {
  rig::check_environment(options.environment);  // `record` is to take the name
  hold_interrupts();
  const simulation::VirtualRigConfig config = simulated_rig(options.seed, options.environment, options.parts);
  SimulatedPorts ports(config, FirmwareChoice::avr_image);
  if (!options.profile.empty()) rig::write_profile(options.profile, profile_of(config, ports.paths()));
  ports.start();
  announce(options, config, ports);
  wait_for_interrupt();
  ports.stop();
  print_tally(ports.tally(), options.json);
  return ExitCode::ok;
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "recording_setup.h"

#include <fmt/format.h>

#include <algorithm>

#include "build_information.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

/// What the simulated rig differs in from the default one, and its world, for the session's own description
/// of it.
std::string differences_text(const SimulatedParts& parts, const simulation::VirtualRigConfig& rig) {
  std::string text;
  if (parts.servo) text += ", servo " + *parts.servo;
  if (parts.camera) text += ", camera " + *parts.camera;
  if (parts.gyro) text += ", gyro " + *parts.gyro;
  if (rig.scene != rig.environment) text += ", scene " + rig.scene;
  return text + ", world " + simulation::text_of(rig.world);
}

/// A simulated hand turns for so long.
constexpr double simulated_by_hand_s = 90.0;

rig::SweepPlan plan_without_servo(const RecordOptions& options, const ChosenRig& rig) {
  if (options.plan_is_named || !options.speeds_dps.empty() || options.frames_per_leg ||
      options.valid_per_leg.value_or(0) > 0)
    throw Error(ExitCode::bad_usage, "without a servo no plan is driven", "",
                "leave --plan, --speeds, --frames-per-leg and --valid-per-leg out; --seconds says how long");
  if (rig.simulated) return rig::by_hand_plan(options.seconds.value_or(simulated_by_hand_s));
  return rig::by_hand_plan(options.seconds);
}

void mark_pseudo_terminals(rig::RecordingOptions& recording) {
  const auto is_pseudo = [&](Device device) {
    const std::string& port = recording.profile.link(device).port;
    return !port.empty() && io::is_pseudo_terminal(port);
  };
  if (std::none_of(all_devices.begin(), all_devices.end(), is_pseudo)) return;
  recording.simulated = true;
  recording.simulation = "pseudo terminals, served by another program";
}

std::unique_ptr<SimulatedPorts> simulated_ports(const simulation::VirtualRigConfig& config,
                                                rig::RecordingOptions& recording) {
  auto ports = std::make_unique<SimulatedPorts>(config, FirmwareChoice::avr_image);
  for (Device device : all_devices)
    if (recording.profile.has(device)) recording.profile.link(device).port = ports->paths()[device];
  recording.simulation = "ports, " + ports->firmware_description();
  ports->start();
  return ports;
}

}  // namespace

rig::RecordingOptions recording_options(const RecordOptions& options, const ChosenRig& rig,
                                        const rig::SweepPlan& plan) {
  rig::RecordingOptions recording;
  recording.environment = options.environment;
  recording.output = options.output;
  recording.title = fmt::format("{}, plan {}", options.environment, plan.name);
  recording.licence = options.licence;
  recording.operator_name = options.operator_name;
  recording.place = options.place;
  recording.note = options.note;
  recording.profile = rig.profile;
  recording.plan = plan;
  recording.sync_period = std::chrono::milliseconds(options.sync_ms);
  recording.replug_patience_s = options.replug_patience_s;
  recording.preflight = options.preflight ? rig::PreflightMode::refuse : rig::PreflightMode::warn;
  recording.simulated = rig.simulated.has_value();
  recording.simulation_seed = options.rig.simulated_seed;
  recording.creator = std::string("thermorig ") + build_information::version;
  recording.creator_git = build_information::git;
  return recording;
}

rig::SweepPlan chosen_plan(const RecordOptions& options, const ChosenRig& rig) {
  if (!rig.profile.servo.is_there()) return plan_without_servo(options, rig);
  if (options.seconds)
    throw Error(ExitCode::bad_usage, "--seconds is for a rig without a servo: a sweep has a plan", "",
                "--plan quick, or --no-servo");
  rig::PlanOverrides overrides;
  overrides.magnitudes_dps = options.speeds_dps;
  overrides.frames_per_leg = options.frames_per_leg;
  overrides.valid_per_leg = options.valid_per_leg;
  return rig::load_plan(options.plan, options.environment, options.rig.simulated_seed.value_or(1), overrides);
}

std::unique_ptr<SimulatedPorts> switch_on(const RecordOptions& options, const ChosenRig& rig,
                                          rig::RecordingOptions& recording) {
  std::unique_ptr<SimulatedPorts> ports;
  if (options.fast)
    recording.simulation = "virtual time, firmware's host build";
  else if (rig.simulated)
    ports = simulated_ports(*rig.simulated, recording);
  else
    mark_pseudo_terminals(recording);
  if (rig.simulated) recording.simulation += differences_text(options.rig.parts, *rig.simulated);
  return ports;
}

}  // namespace thermorig::app

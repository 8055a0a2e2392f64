// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/rig/recording.h"
#include "thermorig/simulated_ports/simulated_ports.h"

namespace thermorig::app {

/// What the command line says of a recording, for a rig and a plan.
rig::RecordingOptions recording_options(const RecordOptions& options, const ChosenRig& rig,
                                        const rig::SweepPlan& plan);

/// The plan that the command line names, with what it changes in it. Throws Error(bad_usage).
rig::SweepPlan chosen_plan(const RecordOptions& options);

/// What the simulated rig differs in from the default one, for the session's own description of it.
std::string simulated_parts(const RigOptions& rig);

/// A program stands behind a pseudo terminal, `thermorig simulate` more often than not: what comes from one
/// must not pass for real data.
void mark_pseudo_terminals(rig::RecordingOptions& recording);

/// Switches a simulated rig on and gives its ports to the recording, which then uses them as it uses any
/// other. Nothing for a real rig.
std::unique_ptr<SimulatedPorts> simulated_ports(const ChosenRig& rig, rig::RecordingOptions& recording);

}  // namespace thermorig::app

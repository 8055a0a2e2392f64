// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::app {

/// What the command line says of a recording, for a rig and a plan.
rig::RecordingOptions recording_options(const RecordOptions& options, const ChosenRig& rig,
                                        const rig::SweepPlan& plan);

/// The plan that the command line names, with what it changes in it. Throws Error(bad_usage).
rig::SweepPlan chosen_plan(const RecordOptions& options, const ChosenRig& rig);

/// Switches a simulated rig on, but in virtual time, and gives its ports to the recording, which then uses
/// them as it uses any other; nothing for a real rig. Says in the recording whether and how it is simulated:
/// a program stands behind a pseudo terminal, `thermorig simulate` more often than not, and what comes from
/// one must not pass for real data.
std::unique_ptr<SimulatedPorts> switch_on(const RecordOptions& options, const ChosenRig& rig,
                                          rig::RecordingOptions& recording);

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "options.h"
#include "thermorig/core/profile.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::app {

/// The rig that the command line names: its profile, and the simulator's configuration where it is simulated.
struct ChosenRig {
  RigProfile profile;
  std::optional<simulation::VirtualRigConfig> simulated;
};

/// Profile file, then what the command line changes in it. Throws Error(bad_usage) for words that contradict
/// each other or do not name the port of every device that is needed.
ChosenRig chosen_rig(const RigOptions& options, const std::string& environment,
                     const PerDevice<bool>& needed = {{true, true, true}});

/// Gives the simulated rig without a servo somebody who turns it for so long: a rest of 12 s, turns of more
/// than a whole one both ways at several speeds, a rest.
void turn_by_hand(ChosenRig& rig, HostTime start, double seconds);

/// A simulated rig with one of the servos "winch", "180", "270", "continuous" and one of the cameras "half",
/// "full", one of the gyros "calibrated", "typical", "raw".
simulation::VirtualRigConfig simulated_rig(std::uint64_t seed, const std::string& environment,
                                           const SimulatedParts& parts);

}  // namespace thermorig::app

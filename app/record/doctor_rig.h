// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "chosen_rig.h"
#include "options.h"
#include "thermorig/rig/doctor/check.h"

namespace thermorig::app {

/// Opens the rig's ports, listens for some seconds and applies the preflight check: nothing is armed, nothing
/// moves, nothing is written. A simulated rig is listened to in virtual time.
std::vector<doctor::Check> listen_to_rig(const RecordOptions& options, const ChosenRig& rig);

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/rig/recording/virtual_recording.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::app {

/// rig::record_virtual() of a simulated rig, with the firmware's host build, from the rig's own start.
rig::RecordingResult record_virtual(const simulation::VirtualRigConfig& config, rig::VirtualOptions options);

}  // namespace thermorig::app

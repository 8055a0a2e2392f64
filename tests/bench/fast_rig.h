// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::bench {

/// The most that a rig sends: 64 frames/s and 1000 gyro samples/s, each device a USB device of its own.
simulation::VirtualRigConfig fast_rig();

}  // namespace thermorig::bench

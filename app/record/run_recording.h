// SPDX-License-Identifier: MIT
#pragma once

#include "chosen_rig.h"
#include "thermorig/rig/recording/port_recording.h"

namespace thermorig::app {

/// One recording, whatever shows it: on ports or, in virtual time, of the simulated rig with the firmware's
/// host build. Throws as rig::record_ports() and rig::record_virtual().
rig::RecordingResult run_recording(const ChosenRig& rig, bool in_virtual_time,
                                   const rig::PortOptions& options);

}  // namespace thermorig::app

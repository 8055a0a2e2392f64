// SPDX-License-Identifier: MIT
#pragma once

#include "c99/thermorig_odometer.h"
#include "thermorig/core/profile.h"

namespace thermorig::board_odometer {

/// What the board's odometer is told of a rig. Throws Error(bad_usage) where its memory is too small for the
/// rig: a lens of less than 30 or more than 115 degrees, a camera below 0.5 frames a second.
thermorig_odometer_profile board_profile(const RigProfile& rig);

}  // namespace thermorig::board_odometer

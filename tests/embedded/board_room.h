// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "odometer/room.h"
#include "thermorig/core/profile.h"

namespace thermorig::tests {

/// A room in which the shaft turns to and fro, never at one speed for long.
odometer::Room turning_room(double duration_s);

/// Gears shake the gyro, along the shaft and across it.
void shake(std::vector<odometer::Seen>& all);

/// All that a board is told of what was seen.
std::string recording_of(const std::vector<odometer::Seen>& all, const RigProfile& rig);

}  // namespace thermorig::tests

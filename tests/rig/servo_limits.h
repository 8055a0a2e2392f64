// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/simulation/firmware.h"

namespace thermorig::rig::test {

/// From the first pulse to the last no pulse asked for an angle or, from one to the next, for a speed beyond
/// the servo's limits; and there were pulses.
void expect_within_limits(const std::vector<simulation::PulseEdge>& pulses, const ServoProfile& servo);

}  // namespace thermorig::rig::test

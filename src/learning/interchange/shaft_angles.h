// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/learning/interchange/tum.h"

namespace thermorig::interchange {

/// The shaft by the servo's model at the end of each frame's exposure, but where telemetry is missing or says
/// that the servo does not hold.
std::vector<AngleAt> shaft_angles(const session::Session& session);

}  // namespace thermorig::interchange

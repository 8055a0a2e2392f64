// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/sync.h"

namespace thermorig::labels {

/// No servo's loop is taken to be slower.
inline constexpr double least_loop_hz = 0.5;

/// How long after a change of the commanded speed the shaft's is within 1 % of the change: delay, one pulse
/// period, and the loop.
double settle_s(const ServoResponse& response);

}  // namespace thermorig::labels

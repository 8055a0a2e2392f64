// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/pulse_scale.h"

namespace thermorig::labels {

/// No servo's loop is taken to be slower.
inline constexpr double least_loop_hz = 0.5;

/// Gain of a response where the servo is commanded `value`, relative to its mean: straight between the knots,
/// constant beyond the first and the last.
double gain_at(const ServoResponse& response, const PulseScale& scale, double value);

/// How long after a change of the commanded speed the shaft's is within 1 % of the change: delay, one pulse
/// period, and the loop.
double settle_s(const ServoResponse& response);

}  // namespace thermorig::labels

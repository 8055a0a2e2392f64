// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>

#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

/// Of the servo's pulses, as a duration and in seconds; telemetry comes twice as often
/// (protocols/servo_link.md, "Telemetry").
inline constexpr HostDuration pulse_period = std::chrono::microseconds(PulseTrain::period_us);
inline constexpr double pulse_period_s = 1e-6 * PulseTrain::period_us;
inline constexpr std::int64_t message_us = PulseTrain::period_us / 2;

}  // namespace thermorig::labels

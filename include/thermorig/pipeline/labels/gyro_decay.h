// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::labels {

/// By which share of the commanded speed a gyro's rate falls in a second while the shaft turns at one speed:
/// the filter of a device that fuses its sensors takes a steady turn for a bias (HWT905 and others). 0: it is
/// not seen. What a servo's slope changes along its travel is of the other sign the other way, and one that
/// is too weak for the faster half of the speeds says nothing: both directions of the slower half count.
double gyro_decay_per_s(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                        const GyroErrors& errors);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

/// How late a gyro's low-pass makes what it shows, into `errors.filter_delay_s`: as the profile states it, or
/// the device itself (`device_hz`, read back) where the profile states nothing or something else, unless the
/// colour of the noise at rest, which passes the same filter, contradicts it; else by that noise; else 0 +-
/// 18 ms: what the narrowest filter does (5 Hz; RM-MPU-6000A register 26) lies within three times that. A
/// second order is assumed: 0.225 / bandwidth. Noise says nothing where the resolution hides it, or where
/// there are less than some two seconds of rest. Where the gyro calls rest zero and nothing is stated, it is
/// the noise of the two other axes while the shaft turns evenly, with 30 % more of uncertainty.
void fit_gyro_filter(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                     const GyroProfile& profile, GyroErrors& errors, std::optional<double> device_hz = {});

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/storage/session/servo_rests.h"

namespace thermorig::calibration {

using session::Rest;

/// Times in which nothing turned the gyro: the servo's rests. Where there is no telemetry at all, nothing
/// drove: the whole time of the gyro.
std::vector<Rest> rests_of(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro);

/// What the gyro shows while nothing turns it.
struct RestingGyro {
  double bias_dps = 0.0;
  double spread_dps = 0.0;  // standard deviation of the means of parts of 2 s
  double noise_dps = 0.0;   // of a sample
  double drift_dps = 0.0;   // last third minus first third
  double rest_s = 0.0;      // that took part
  std::size_t parts = 0;
};

/// Parts in which somebody moved the rig are left out: they differ from the others. None if less than 6 s of
/// quiet remain.
std::optional<RestingGyro> resting_gyro(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro);

}  // namespace thermorig::calibration

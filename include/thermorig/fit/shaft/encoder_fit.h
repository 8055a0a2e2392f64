// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

/// What a recording says of the sensor on its shaft.
struct EncoderFit {
  EncoderProfile encoder;  // direction, offset, errors, and error_deg: what these may be off by
  double once_deg = 0.0;   // amplitudes of the errors
  double twice_deg = 0.0;
  double turned_deg = 0.0;  // that the shaft turned in the legs that took part
  std::size_t legs = 0;
  Estimate gyro_share{};   // of the corrected gyro: deg that it shows for each deg of the shaft
  double noise_deg = 0.0;  // of a reading, from one to the next
};

struct EncoderFitResult {
  std::optional<EncoderFit> fit;
  std::string why_not;  // ready to print, if there is none
};

/// Over the steady parts of legs, each at one speed: what the sensor sends is held against the angle that the
/// gyro integrates. A leg has an offset and a rate of its own, in which bias and scale of the gyro go; what
/// repeats with the sensor's angle once and twice a turn is its error. `profile`: what stays as it is.
EncoderFitResult fit_encoder(std::span<const TimedShaft> shaft, std::span<const TimedGyro> gyro,
                             std::span<const TimedServo> servo, const GyroErrors& errors,
                             const EncoderProfile& profile);

/// Whether labels may be made by the sensor. They may not where it is not calibrated (unless
/// `maker_states_deg` says what its errors are), where it contradicts both gyro and command by more than 3
/// standard deviations of what these state, or where its errors of a turn are no longer the profile's.
ShaftReport judge_shaft(std::span<const TimedShaft> shaft, std::span<const TimedGyro> gyro,
                        std::span<const TimedServo> servo, const GyroErrors& errors,
                        const RigProfile& profile, std::optional<double> maker_states_deg);

}  // namespace thermorig::fit

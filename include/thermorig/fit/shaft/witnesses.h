// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

/// Below this share of what is commanded nothing turns: so much shows about an axis that does not (MPU-6000,
/// table 6.1).
inline constexpr double least_turning_share = 0.02;

/// What images say of the speed without any gyro, as a share of the commanded one; none: why not.
struct ImagesShare {
  std::optional<Estimate> share;
  std::string why_not;  // ready to print
};

/// Compares command, gyro and images over the steady parts of the legs, and names the likely cause where two
/// of them contradict each other beyond what the profile states: for the gyro its unit, range, sign or axis,
/// for the command a servo that does not follow, for the images the camera's `mirrored` or its lens. With a
/// third witness that agrees with one of the two, the other is the outlier; else nobody knows. `errors`: by
/// fit_gyro_errors() or the profile. Streams in order, gyro and servo on one clock.
Witnesses compare_witnesses(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro,
                            const GyroErrors& errors, const RigProfile& profile, ImagesShare images = {});

}  // namespace thermorig::fit

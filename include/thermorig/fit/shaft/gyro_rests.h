// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

/// The opening rest of a rig without a servo must be this long, in s, and begin so soon.
inline constexpr double least_opening_rest_s = 5.0;
inline constexpr double latest_opening_rest_s = 3.0;

/// Where a rig without a servo stands still: the opening rest, then those whose mean rate is close to its.
/// Seconds from the first sample, ascending. Empty: there is no opening rest. Without images a steady turn
/// looks like a rest: ask are_images_still() too.
std::vector<Interval> rests_by_gyro(std::span<const TimedGyro> gyro);

/// False where the frames exposed from `begin` to `end` show that the camera turned meanwhile: pixels differ
/// more between frames that lie far apart than between neighbours. True where they show nothing of the kind,
/// or where there are fewer than eight.
bool are_images_still(std::span<const TimedFrame> frames, HostTime begin, HostTime end);

/// The gyro's errors of a rig without a servo, by its rests: those of rests_by_gyro() if the images of the
/// first agree. Without a rest, or where the gyro zeroes itself there, `bias_dps` is none.
GyroErrors fit_gyro_errors_without_servo(std::span<const TimedGyro> gyro, std::span<const TimedFrame> frames,
                                         const GyroProfile& profile);

}  // namespace thermorig::fit

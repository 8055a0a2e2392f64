// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
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

/// The gyro's errors as far as a recording and the profile tell: bias from the stretches in which the servo
/// has long been at rest, scale from the profile, runs of exact zeros.
GyroErrors fit_gyro_errors(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                           const GyroProfile& profile);

/// The share of the commanded speed that a gyro's rate falls in a second while the shaft turns at one speed:
/// the filter of a device that fuses its sensors takes a steady turn for a bias (HWT905 and others). 0: it is
/// not seen. What a servo's slope changes along its travel is of the other sign the other way, and one that
/// is too weak for the faster half of the speeds says nothing: both directions of the slower half count.
double gyro_decay_per_s(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                        const GyroErrors& errors);

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

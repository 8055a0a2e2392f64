// SPDX-License-Identifier: MIT
#pragma once

#include "clock_fits.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"
#include "thermorig/fit/motion/panorama_fit.h"

namespace thermorig::fit {

// Constants of the profile against what this session's own data say of them.
// docs/decisions/0014-constants-are-checked.md

/// Takes what whole turns say into the gyro's scale: weighed by inverse variance, or in its place where a
/// calibrated scale lies beyond contradiction_deviations of it.
void apply_turns(const motion::TurnResult& turns, GyroErrors& errors);

/// The group delay of the gyro's filter is latency: it is taken off the gyro's times, and its uncertainty is
/// added to that of the latency.
void apply_filter_delay(const GyroErrors& errors, ClockFit& gyro);

/// Shifts the camera's times by what its images say about its latency against the gyro, whose clock stands
/// in `gyro`. A calibrated latency stays while the images lie within contradiction_deviations, else theirs
/// takes its place, since labels hang on the gyro; an assumed one is weighed against them by inverse
/// variance. What is uncertain about the gyro's latency is so about the camera's too, which is measured
/// against it; and a filter that no profile states may be what changed, which then contradicts no
/// calibration.
void apply_camera_offset(const CameraProfile& profile, const GyroErrors& errors, const ClockReport& gyro,
                         CameraOffset& offset, ClockFit& camera);

}  // namespace thermorig::fit

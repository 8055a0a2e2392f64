// SPDX-License-Identifier: MIT
#pragma once

#include "clock_fits.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"

namespace thermorig::pipeline {

/// Shifts the camera's times by what its images say about its latency, weighed by inverse variance against
/// what the profile says: a calibrated latency stays, an assumed one gives way. The gyro, which the images
/// are held against, has a latency of its own that is uncertain too. Nothing happens where the images are
/// less certain than the profile.
void apply_camera_offset(const RigProfile& profile, CameraOffset& offset, ClockFit& camera);

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/fit/shaft/witnesses.h"

namespace thermorig::fit {

/// How fast the images turn by themselves for each deg/s commanded: no gyro is asked. Some legs, evenly
/// spread, are looked at. The uncertainty is what the legs differ by; that of the lens is not in it. `frames`
/// carry the exposures of both halves; both in order, on one clock.
ImagesShare images_share(std::span<const TimedFrame> frames, std::span<const TimedServo> servo,
                         const CameraProfile& camera);

}  // namespace thermorig::fit

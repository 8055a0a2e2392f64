// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/run_all.h"
#include "thermorig/core/sample.h"

namespace thermorig::odometer {

/// What a sweep says of the lens, in the profile's terms (CameraProfile), one standard deviation each.
struct LensFit {
  Estimate pitch_scale{1.0, 0.0};
  Estimate distortion, tilt_deg, roll_deg, row_spread;
  double turned_deg = 0.0;   // from the one end to the other
  bool is_closed = false;    // a whole turn came back to what was seen before
  std::uint32_t halves = 0;  // chess halves that took part
};

/// The lens with which all halves of a recording that were seen at a steady speed below 70 deg/s make one
/// panorama. The odometer's tracker tells where they look; then a bundle adjustment finds a heading for each
/// half, the panorama and the lens at once. Where a whole turn closes, the pitch owes nothing to the gyro:
/// 360 degrees are its measure; else it is known only together with the gyro's scale, whose uncertainty is in
/// it. Uncertainties are from the spread among blocks of 5 s; what is not told keeps what is known
/// beforehand: 3 %, 5 %, 5 deg, 5 deg and 0.7 of a period. `frames`: with the exposures of both halves;
/// `gyro`: the rate about the axis; in order. Nothing, and in `why_not` a text ready to print, where they do
/// not tell.
struct LensAnswer {
  std::optional<LensFit> fit;
  std::string why_not;
};
LensAnswer fit_lens(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                    const GyroProfile& gyro_profile, const CameraProfile& camera,
                    const RunAll& run_all = in_turn);

}  // namespace thermorig::odometer

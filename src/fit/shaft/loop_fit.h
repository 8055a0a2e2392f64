// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "gyro_integral.h"
#include "shaft_curve.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

/// How the shaft follows a change of speed.
struct LoopFit {
  Estimate delay_s;
  double loop_hz = 0.0;
  double dead_band_deg = 0.0;
  double residual_dps = 0.0;  // root mean square of what is left around the changes, means over 20 ms
};

/// Delay, bandwidth and dead band that make the model's mean rate over 20 ms (one pulse period: the ripple of
/// the pulses plays no part), seen through the gyro's low-pass of the group delay `filter_delay_s` (which the
/// gyro's times have in them), most like the gyro's, around the changes of speed; up
/// to a factor and a constant, which are found elsewhere. None if there are fewer than three changes that the
/// gyro saw, or the gyro does not follow them.
std::optional<LoopFit> fit_loop(std::span<const PulseAt> pulses, std::span<const Interval> changes,
                                const GyroIntegral& gyro, double filter_delay_s, const ServoProfile& profile);

}  // namespace thermorig::fit

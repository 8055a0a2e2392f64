// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "thermorig/core/profile.h"

namespace thermorig {

inline constexpr double stated_delay_error = 0.1;  // relative: bandwidths in data sheets are nominal
inline constexpr double unknown_delay_s = 0.018;   // of a low-pass that nobody stated

/// How far off may be what the profile says of how late the low-pass makes the gyro, one standard deviation.
inline double delay_uncertainty_s(const GyroProfile& gyro) {
  const auto delay_s = gyro.stated_delay_s();
  return delay_s ? stated_delay_error * *delay_s : unknown_delay_s;
}

/// The same of all that makes the gyro's times late.
inline double time_uncertainty_s(const GyroProfile& gyro) {
  return std::hypot(gyro.link.latency_uncertainty_s, delay_uncertainty_s(gyro));
}

}  // namespace thermorig

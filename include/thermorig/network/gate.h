// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thermorig::network {

/// Below and above these gains (Kg) the gate of a fusion network gives (almost) all to one side.
inline constexpr double closed_gate = 0.02, open_gate = 0.98;

/// Of a histogram of gains, 0.05 wide each; 1.0 lies in the last.
inline constexpr std::size_t gain_bins = 20;
inline std::size_t gain_bin(double gain) {
  const double bin = std::floor(gain * static_cast<double>(gain_bins));
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(gain_bins - 1)));
}

/// The best Kg in y = Kg y_th + (1 - Kg) y_gyro (paper eq. 2) for a gyro whose bias is known within one sigma
/// and images that state theirs: the share of the bias's variance in the sum. NaN where one is.
inline double gain_beside(double bias_sigma_dps, double thermal_sigma_dps) {
  const double bias_variance = bias_sigma_dps * bias_sigma_dps;
  return bias_variance / (bias_variance + thermal_sigma_dps * thermal_sigma_dps);
}

}  // namespace thermorig::network

// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <span>

namespace thermorig {

/// A figure that is not known.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A measured value and one standard deviation of it, in the unit that the name of the variable says.
struct Estimate {
  double value = 0.0;
  double uncertainty = 0.0;
  bool operator==(const Estimate&) const = default;
};

/// Mean of estimates of one quantity, weighted by 1 / uncertainty^2; at least one, uncertainties above 0.
/// Where they scatter more than their uncertainties say, the scatter counts (Birge's ratio of metrology).
Estimate weighted_mean(std::span<const Estimate> estimates);

}  // namespace thermorig

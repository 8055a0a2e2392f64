// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

namespace thermorig {

/// A figure that is not known.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A measured value and one standard deviation of it, in the unit that the name of the variable says.
struct Estimate {
  double value = 0.0;
  double uncertainty = 0.0;
  bool operator==(const Estimate&) const = default;
};

}  // namespace thermorig

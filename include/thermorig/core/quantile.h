// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace thermorig {

/// The value below which `share` (0..1) of the sorted values lie: linear interpolation between order
/// statistics, as NumPy's default. NaN of none.
double quantile(std::span<const double> sorted, double share);

}  // namespace thermorig

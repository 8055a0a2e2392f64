// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace thermorig::timing {

/// The value below which `share` of them lie, rounded down; `values` are reordered. 0 if there is none.
double quantile(std::vector<double>& values, double share);

/// The same, rounded up.
double upper_quantile(std::vector<double>& values, double share);

}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "parabola.h"

namespace thermorig::timing {

/// Slope of the highest line below all of `ceilings` (ascending in x): that side of the lower hull which is
/// above the mean of x (Zhang, Liu and Xia, INFOCOM 2002). None of it: `fallback`.
double lower_line_slope(std::span<const Ceiling> ceilings, double fallback);

}  // namespace thermorig::timing

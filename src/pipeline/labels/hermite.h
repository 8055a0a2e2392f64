// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::labels {

/// The cubic through two points with their slopes, at `share` of the way from one to the other.
inline double hermite(double from, double from_slope, double to, double to_slope, double length,
                      double share) {
  const double rest = 1.0 - share;
  const double rise = to - from;
  const double bend = rest * (from_slope * length - rise) - share * (to_slope * length - rise);
  return from + share * rise + share * rest * bend;
}

}  // namespace thermorig::labels

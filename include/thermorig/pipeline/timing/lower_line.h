// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace thermorig::timing {

/// A point that a clock's curve may not exceed, in seconds: `x` on the device's clock, `y` on the host's.
struct Ceiling {
  double x = 0.0;
  double y = 0.0;
};

/// y = a + b (x - middle), seconds.
struct Line {
  double middle = 0.0;
  double a = 0.0;
  double b = 0.0;

  double at(double x) const { return a + b * (x - middle); }
};

/// The line below all of `ceilings` (at least one, ascending in x) that is highest at `middle`: that side of
/// the lower hull which is there (Zhang, Liu and Xia, INFOCOM 2002), |b| at most `slope_limit`.
Line highest_line(std::span<const Ceiling> ceilings, double middle, double slope_limit);

/// Drops from `ceilings` (ascending in x), from `first` on, all that no parabola of at most that curvature
/// can touch: with the curvature's bow added what is left is a lower convex hull.
void keep_lower_hull(std::vector<Ceiling>& ceilings, std::size_t first, double curvature);

/// Slope of the line that is highest at the mean of x, without a limit. Fewer than two ceilings: `fallback`.
double lower_line_slope(std::span<const Ceiling> ceilings, double fallback);

}  // namespace thermorig::timing

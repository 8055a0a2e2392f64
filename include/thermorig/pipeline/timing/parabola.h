// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/time.h"

namespace thermorig::timing {

/// One inequality that a read chunk proves: the message at `device_s` on its device's clock had begun to be
/// sent by `latest`, since a later byte of it had arrived (arrival minus the wire time of the bytes up to
/// it).
struct LatestBegin {
  double device_s = 0.0;
  HostTime latest{};
  bool inside = false;  // the chunk ended within the message: the link cut it off while bytes were coming
  double wire_s = 0.0;  // wire time from the message's begin to the chunk's end: was taken off the arrival
  double held_s = 0.0;  // how long the link had kept the chunk's first byte by then, at least
};

/// A point that a clock's curve may not exceed, in seconds: `x` on the device's clock, `y` on the host's.
struct Ceiling {
  double x = 0.0;
  double y = 0.0;
};

/// y = a + b (x - middle) + c (x - middle)^2, seconds.
struct Parabola {
  double middle = 0.0;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  double at(double x) const { return a + (b + c * (x - middle)) * (x - middle); }
  double slope(double x) const { return b + 2.0 * c * (x - middle); }
};

/// What a clock can do: |b| and |c| at most, per second.
struct ParabolaLimits {
  double slope = 0.0;
  double curvature = 0.0;
};

/// Where a curve is to be high: moments of the x at which its mean is taken, about the middle.
struct Moments {
  double first = 0.0;   // mean of (x - middle)
  double second = 0.0;  // mean of its square
};

/// The highest parabola below all of `ceilings` (at least one): the mean of it at the moments' places is the
/// greatest within the limits. A linear program in three unknowns, solved exactly (dual simplex).
/// `half_width` > 0 is the scale of x about the middle.
Parabola highest_below(std::span<const Ceiling> ceilings, double middle, double half_width,
                       const Moments& moments, const ParabolaLimits& limits);

/// How much higher the highest parabola would be at `x` without the ceilings that hold `highest` up.
double rise_without_holding(std::span<const Ceiling> ceilings, const Parabola& highest, double x,
                            double half_width, const Moments& moments, const ParabolaLimits& limits);

/// Drops from `ceilings` (ascending in x), from `first` on, all that no parabola of at most that curvature
/// can touch: with the curvature's bow added what is left is a lower convex hull.
void keep_lower_hull(std::vector<Ceiling>& ceilings, std::size_t first, double curvature);

/// Slope of the highest line below all of `ceilings` (ascending in x): that side of the lower hull which is
/// above the mean of x (Zhang, Liu and Xia, INFOCOM 2002). None of it: `fallback`.
double lower_line_slope(std::span<const Ceiling> ceilings, double fallback);

}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/pipeline/timing/lower_line.h"

namespace thermorig::fit {

using timing::Ceiling;

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

}  // namespace thermorig::fit

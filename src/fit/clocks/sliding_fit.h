// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "parabola.h"

namespace thermorig::fit {

/// How a sliding fit is cut.
struct SlidingWindow {
  double length_s = 60.0;  // of the device's clock, over which one parabola has to do
  double block_s = 3.0;    // between knots

  /// As long as a parabola can follow a clock of that wander, and long enough for a few dozen messages.
  static SlidingWindow of(double wander_ppm, double message_rate_hz);
};

/// The highest smooth curve below all of a segment's ceilings: a parabola for each block of them, the best
/// one over a window around it, blended from knot to knot. All parabolas of a knot keep below all ceilings of
/// its window, so the blend does too.
class SlidingFit {
 public:
  /// `ceilings`: at least one, ascending in x. `slope_limit`: how far the clock may run from its mean rate.
  SlidingFit(std::span<const Ceiling> ceilings, const SlidingWindow& window, double slope_limit);

  struct Knot {
    double x = 0.0;
    Parabola curve;
    double rise = 0.0;  // how much higher the curve would be at x without the messages that hold it up
  };
  const std::vector<Knot>& knots() const { return knots_; }

  /// Values at `x`, which may be asked for in any order; quickest in ascending order.
  double at(double x);
  double slope(double x);

  /// `values`, one a knot, blended like the curve.
  double blend(std::span<const double> values, double x);

 private:
  struct Block {
    std::size_t begin = 0;  // into reduced_
    std::size_t end = 0;
    double first_x = 0.0;
    double last_x = 0.0;
  };
  void reduce(std::span<const Ceiling> ceilings, double block_s);
  void fit_knot(std::size_t block);
  Moments moments(std::size_t begin, std::size_t end, double middle) const;
  void seek(double x);
  double smooth_share(double x) const;

  SlidingWindow window_;
  ParabolaLimits limits_;
  std::vector<Ceiling> reduced_;
  std::vector<Block> blocks_;
  std::vector<Knot> knots_;
  std::size_t place_ = 0;  // knot at or before the x asked for last
};

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include "pipeline/timing/sliding_fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::timing {
namespace {

/// A clock whose rate swings by so much that neighbouring windows have other parabolas.
SlidingFit fit_of_a_swinging_clock() {
  std::vector<Ceiling> ceilings;
  for (int i = 0; i < 600; ++i) {
    const double x = 0.1 * i;
    ceilings.push_back({x, 0.004 * std::sin(x / 6.0) + 0.001 * std::abs(std::sin(97.0 * x))});
  }
  return SlidingFit(ceilings, {.length_s = 12.0, .block_s = 2.0}, 1e-3);
}

TEST(SlidingFit, IsHalfOfEachParabolaHalfwayBetweenTheirKnots) {
  SlidingFit fit = fit_of_a_swinging_clock();
  const auto& knots = fit.knots();
  double most_apart_s = 0.0;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double x = 0.5 * (knots[i].x + knots[i + 1].x);
    const double left = knots[i].curve.at(x);
    const double right = knots[i + 1].curve.at(x);
    EXPECT_NEAR(fit.at(x), 0.5 * (left + right), 1e-12) << x;
    most_apart_s = std::max(most_apart_s, std::abs(left - right));
  }
  EXPECT_GT(most_apart_s, 1e-5);
}

TEST(SlidingFit, HasNoKinkAtAKnot) {
  SlidingFit fit = fit_of_a_swinging_clock();
  const double step = 1e-4;
  for (const SlidingFit::Knot& knot : fit.knots()) {
    if (&knot == &fit.knots().front() || &knot == &fit.knots().back()) continue;
    const double left = (fit.at(knot.x) - fit.at(knot.x - step)) / step;
    const double right = (fit.at(knot.x + step) - fit.at(knot.x)) / step;
    EXPECT_NEAR(left, knot.curve.slope(knot.x), 1e-7) << knot.x;
    EXPECT_NEAR(right, knot.curve.slope(knot.x), 1e-7) << knot.x;
  }
}

}  // namespace
}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#include "scene_prior.h"

#include <algorithm>
#include <cmath>

namespace thermorig::likelihood {

namespace {

// Scenes have few sharp edges and much that is large: their spectrum falls with the square of the frequency,
// as that of exp(-distance / length) does. Lengths of 8 and 30 pitches do as well.
constexpr double correlation_length = 15.0;
constexpr double response_width = 1.9;  // of a box as wide as the response of a pixel and its lens
constexpr double least_sweep = 0.02;    // below that, differences of large numbers say nothing

/// Of exp(-|x| / length), without a kink at 0.
double fourth_integral(double x) {
  constexpr double length = correlation_length;
  const double far = std::abs(x);
  return length * (far * far * far / 6.0 - length * far * far / 2.0 +
                   length * length * (far + length * std::expm1(-far / length)));
}

/// Mean over two boxes of that width, by the second integral.
template <typename Integral>
double over_boxes(double x, double width, const Integral& second_integral) {
  return (second_integral(x + width) - 2.0 * second_integral(x) + second_integral(x - width)) /
         (width * width);
}

}  // namespace

double swept_covariance(double distance, double speed) {
  const double sweep = std::max(least_sweep, std::abs(speed));
  return over_boxes(distance, sweep, [](double x) { return over_boxes(x, response_width, fourth_integral); });
}

double place_of(std::size_t half, std::size_t halves, std::size_t pixel, double speed) {
  const double exposures = static_cast<double>(half) - 0.5 * static_cast<double>(halves - 1);
  return static_cast<double>(2 * pixel + half % 2) + speed * exposures;
}

}  // namespace thermorig::likelihood

// SPDX-License-Identifier: MIT
#include "window_covariance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "window_lines.h"

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

void take_off_means(Eigen::MatrixXd& covariance) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  for (Eigen::Index first = 0; first < covariance.rows(); first += pixels) {
    auto rows = covariance.middleRows(first, pixels);
    rows.rowwise() -= rows.colwise().mean().eval();
  }
}

/// Of every second pixel from one place on with those from another on: it depends on nothing but how far
/// apart they look.
Eigen::MatrixXd shared_by(double place, double other_place, double speed) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  Eigen::MatrixXd both(pixels, pixels);
  for (std::size_t pixel = 0; pixel < line_pixels; ++pixel) {
    const auto apart = static_cast<Eigen::Index>(pixel);
    const auto further = static_cast<double>(2 * pixel);
    both.diagonal(-apart).setConstant(swept_covariance(place + further - other_place, speed));
    both.diagonal(apart).setConstant(swept_covariance(place - other_place - further, speed));
  }
  return both;
}

double computed_likeness(std::size_t wave) {
  const auto& of_rows = wave_table();
  double own = 0.0, shared = 0.0;
  for (std::size_t row = 0; row < half_rows; ++row)
    for (std::size_t other = 0; other < half_rows; ++other) {
      const double both = double{of_rows[row][wave]} * double{of_rows[other][wave]};
      const double rows_apart = 2.0 * (static_cast<double>(row) - static_cast<double>(other));
      own += both * swept_covariance(rows_apart, 0.0);
      shared += both * swept_covariance(rows_apart - 1.0, 0.0);
    }
  return shared / own;
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

Eigen::MatrixXd window_covariance(std::size_t halves, double speed) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  const Eigen::Index lines = static_cast<Eigen::Index>(halves) * pixels;
  Eigen::MatrixXd covariance(lines, lines);
  for (std::size_t one = 0; one < halves; ++one)
    for (std::size_t other = 0; other <= one; ++other) {
      const Eigen::Index row = static_cast<Eigen::Index>(one) * pixels;
      const Eigen::Index column = static_cast<Eigen::Index>(other) * pixels;
      const Eigen::MatrixXd both =
          shared_by(place_of(one, halves, 0, speed), place_of(other, halves, 0, speed), speed);
      covariance.block(row, column, pixels, pixels) = both;
      covariance.block(column, row, pixels, pixels) = both.transpose();
    }
  return covariance;
}

Eigen::MatrixXd covariance_of_classes(std::size_t halves, double speed, double likeness) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  const Eigen::Index size = static_cast<Eigen::Index>(halves) * pixels;
  Eigen::MatrixXd across(size, size);
  for (std::size_t one = 0; one < halves; ++one)
    for (std::size_t other = 0; other < halves; ++other) {
      const double mirrored =
          static_cast<double>(frame_columns - 1) - place_of(other, halves, line_pixels - 1, -speed);
      across.block(static_cast<Eigen::Index>(one) * pixels, static_cast<Eigen::Index>(other) * pixels, pixels,
                   pixels) =
          likeness * shared_by(place_of(one, halves, 0, speed), mirrored, speed).rowwise().reverse();
    }
  Eigen::MatrixXd covariance(2 * size, 2 * size);
  covariance << window_covariance(halves, speed), across,  //
      across.transpose(), window_covariance(halves, -speed);
  return covariance;
}

double likeness_of_classes(std::size_t wave) {
  static const std::array likeness = [] {
    std::array<double, half_rows> all{};
    for (std::size_t i = 0; i < half_rows; ++i) all[i] = computed_likeness(i);
    return all;
  }();
  return likeness[wave];
}

void centre_halves(Eigen::MatrixXd& covariance) {
  take_off_means(covariance);
  covariance.transposeInPlace();
  take_off_means(covariance);
}

}  // namespace thermorig::likelihood

// SPDX-License-Identifier: MIT
#include "window_covariance.h"

#include "scene_prior.h"

namespace thermorig::likelihood {

namespace {

void take_off_means(Eigen::MatrixXd& covariance, std::size_t halves) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  for (Eigen::Index half = 0; half < static_cast<Eigen::Index>(halves); ++half) {
    auto rows = covariance.middleRows(half * pixels, pixels);
    rows.rowwise() -= rows.colwise().mean().eval();
  }
}

/// Of the pixels of one half with those of another: it depends on nothing but how far apart they look.
Eigen::MatrixXd shared_by(std::size_t one, std::size_t other, std::size_t halves, double speed) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  const auto between = [&](std::size_t pixel, std::size_t pixel_of_other) {
    return swept_covariance(
        place_of(one, halves, pixel, speed) - place_of(other, halves, pixel_of_other, speed), speed);
  };
  Eigen::MatrixXd both(pixels, pixels);
  for (std::size_t pixel = 0; pixel < line_pixels; ++pixel) {
    const auto apart = static_cast<Eigen::Index>(pixel);
    both.diagonal(-apart).setConstant(between(pixel, 0));
    both.diagonal(apart).setConstant(between(0, pixel));
  }
  return both;
}

}  // namespace

Eigen::MatrixXd window_covariance(std::size_t halves, double speed) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  const Eigen::Index lines = static_cast<Eigen::Index>(halves) * pixels;
  Eigen::MatrixXd covariance(lines, lines);
  for (std::size_t one = 0; one < halves; ++one)
    for (std::size_t other = 0; other <= one; ++other) {
      const Eigen::Index row = static_cast<Eigen::Index>(one) * pixels;
      const Eigen::Index column = static_cast<Eigen::Index>(other) * pixels;
      const Eigen::MatrixXd both = shared_by(one, other, halves, speed);
      covariance.block(row, column, pixels, pixels) = both;
      covariance.block(column, row, pixels, pixels) = both.transpose();
    }
  return covariance;
}

void centre_halves(Eigen::MatrixXd& covariance, std::size_t halves) {
  take_off_means(covariance, halves);
  covariance.transposeInPlace();
  take_off_means(covariance, halves);
}

}  // namespace thermorig::likelihood

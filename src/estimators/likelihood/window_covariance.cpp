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

}  // namespace

Eigen::MatrixXd window_covariance(std::size_t halves, double speed) {
  const auto lines = static_cast<Eigen::Index>(halves * line_pixels);
  const auto place = [&](Eigen::Index i) {
    const auto at = static_cast<std::size_t>(i);
    return place_of(at / line_pixels, halves, at % line_pixels, speed);
  };
  Eigen::MatrixXd covariance(lines, lines);
  for (Eigen::Index i = 0; i < lines; ++i)
    for (Eigen::Index j = 0; j <= i; ++j)
      covariance(i, j) = covariance(j, i) = swept_covariance(place(i) - place(j), speed);
  return covariance;
}

void centre_halves(Eigen::MatrixXd& covariance, std::size_t halves) {
  take_off_means(covariance, halves);
  covariance.transposeInPlace();
  take_off_means(covariance, halves);
}

}  // namespace thermorig::likelihood

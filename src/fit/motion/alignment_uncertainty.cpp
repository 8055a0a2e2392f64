// SPDX-License-Identifier: MIT
// How well an alignment knows its parameters.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "alignment.h"

namespace thermorig::motion {
namespace {

constexpr double block_s = 4.0;  // longer than the errors of one sweep and the next go together
constexpr double least_contrast = 0.02;
constexpr float least_seen_weight = 1e-3F;

}  // namespace

/// How each view pulls at the parameters, the panorama's share taken out.
Parameters Alignment::pull(const Comparison& comparison, std::size_t index, const Totals& totals) const {
  Parameters pull = totals.change[index] * totals.view_gradient[index];
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const auto [left, right, part] = PanoramaMap::between(places_[index], column);
    const ColumnPixels weighted =
        column_of(comparison.weight, column) * column_of(comparison.residual, column);
    const ColumnPixels to_left =
        (1.0F - part) * weighted / PanoramaMap::at(map_.weight(), left).max(least_seen_weight);
    const ColumnPixels to_right =
        part * weighted / PanoramaMap::at(map_.weight(), right).max(least_seen_weight);
    for (std::size_t p = 0; p < parameter_count; ++p)
      pull[p] -= static_cast<double>((to_left * PanoramaMap::at(totals.push[p], left) +
                                      to_right * PanoramaMap::at(totals.push[p], right))
                                         .sum());
  }
  return pull;
}

/// Blocks of the recording pull independently: sum of the squares of what each of them pulls.
Matrix Alignment::spread_of_pulls(const Totals& totals) const {
  Matrix spread = Matrix::Zero();
  Parameters block = Parameters::Zero();
  double blocks = 0.0;
  const auto block_of = [this](std::size_t i) { return std::floor(views_[i].half.begin_s / block_s); };
  for (std::size_t k = 0; k < views_.size(); ++k) {
    block += pull(compare(k), k, totals);
    if (k + 1 < views_.size() && block_of(k) == block_of(k + 1)) continue;
    spread += block * block.transpose();
    block.setZero();
    blocks += 1.0;
  }
  return spread * (blocks / std::max(1.0, blocks - 2.0));
}

/// Of a symmetric positive definite one: priors on the diagonal keep it so. Rows and columns are scaled so
/// that the diagonal is 1, as parameters differ by many powers of ten.
Matrix Alignment::inverse(const Matrix& matrix) {
  const Parameters scales =
      matrix.diagonal().unaryExpr([](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; });
  const Matrix scaled = scales.asDiagonal() * matrix * scales.asDiagonal();
  return scales.asDiagonal() * scaled.inverse() * scales.asDiagonal();
}

/// Sandwich: the spread of the blocks' pulls, through the inverse curvature, is the parameters' covariance.
/// Noise makes the panorama's slopes look steeper than the surroundings are, and the curvature with them:
/// that share is taken out.
void Alignment::judge(const Totals& totals) {
  const double squares = map_.slope_squared();
  contrast_ = squares > 0.0 ? std::max(0.0, 1.0 - map_.slope_noise(noise_variance_) / squares) : 0.0;
  const double share = std::max(least_contrast, contrast_);
  const Matrix inverted = inverse(with_prior(totals.curvature * (share / noise_variance_)));
  const Matrix spread = with_prior(spread_of_pulls(totals) * (1.0 / (noise_variance_ * noise_variance_)));
  covariance_ = inverted * spread * inverted;
}

}  // namespace thermorig::motion

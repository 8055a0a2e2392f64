// SPDX-License-Identifier: MIT
#include "least_squares.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::labels {

namespace {
constexpr double least_pivot = 1e-300;
}

void LeastSquares::add(std::span<const double> row, double value, double deviation) {
  add_part(0, row, value, deviation);
}

void LeastSquares::add_part(std::size_t first, std::span<const double> row, double value, double deviation) {
  const double weight = 1.0 / (deviation * deviation);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == 0.0) continue;
    for (std::size_t j = 0; j < row.size(); ++j)
      matrix_[(first + i) * size_ + first + j] += weight * row[i] * row[j];
    right_[first + i] += weight * row[i] * value;
  }
}

void LeastSquares::add_prior(std::size_t unknown, double value, double deviation) {
  const double one = 1.0;
  add_part(unknown, std::span(&one, 1), value, deviation);
}

/// Cholesky: the matrix is symmetric and positive definite.
std::vector<double> LeastSquares::solve_for(std::vector<double> right) const {
  std::vector<double> lower(matrix_);
  for (std::size_t j = 0; j < size_; ++j) {
    double pivot = lower[j * size_ + j];
    for (std::size_t k = 0; k < j; ++k) pivot -= lower[j * size_ + k] * lower[j * size_ + k];
    const double root = std::sqrt(std::max(pivot, least_pivot));
    lower[j * size_ + j] = root;
    for (std::size_t i = j + 1; i < size_; ++i) {
      double sum = lower[i * size_ + j];
      for (std::size_t k = 0; k < j; ++k) sum -= lower[i * size_ + k] * lower[j * size_ + k];
      lower[i * size_ + j] = sum / root;
    }
  }
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t k = 0; k < i; ++k) right[i] -= lower[i * size_ + k] * right[k];
    right[i] /= lower[i * size_ + i];
  }
  for (std::size_t i = size_; i-- > 0;) {
    for (std::size_t k = i + 1; k < size_; ++k) right[i] -= lower[k * size_ + i] * right[k];
    right[i] /= lower[i * size_ + i];
  }
  return right;
}

std::vector<double> LeastSquares::solve() const {
  return solve_for(right_);
}

double LeastSquares::variance(std::span<const double> weights) const {
  assert(weights.size() == size_);
  const std::vector<double> answer = solve_for({weights.begin(), weights.end()});
  double sum = 0.0;
  for (std::size_t i = 0; i < size_; ++i) sum += weights[i] * answer[i];
  return sum;
}

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "least_squares.h"

#include <Eigen/Cholesky>
#include <cassert>

namespace thermorig::fit {

void LeastSquares::add(std::span<const double> row, double value, double deviation) {
  add_part(0, row, value, deviation);
}

void LeastSquares::add_part(std::size_t first, std::span<const double> row, double value, double deviation) {
  const double weight = 1.0 / (deviation * deviation);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == 0.0) continue;
    for (std::size_t j = 0; j <= i; ++j) matrix_[(first + i) * size_ + first + j] += weight * row[i] * row[j];
    right_[first + i] += weight * row[i] * value;
  }
}

void LeastSquares::add_prior(std::size_t unknown, double value, double deviation) {
  const double one = 1.0;
  add_part(unknown, std::span(&one, 1), value, deviation);
}

std::vector<double> LeastSquares::solve_for(std::vector<double> right) const {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(size_);
  const Eigen::Map<const Matrix> matrix(matrix_.data(), size, size);
  Eigen::Map<Eigen::VectorXd> answer(right.data(), size);
  answer = matrix.ldlt().solve(answer).eval();  // looks at the lower triangle alone
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

}  // namespace thermorig::fit

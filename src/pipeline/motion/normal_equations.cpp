// SPDX-License-Identifier: MIT
#include "normal_equations.h"

#include <Eigen/LU>
#include <cmath>

namespace thermorig::motion {
namespace {

/// Scales rows and columns so that the diagonal is 1: parameters differ by many powers of ten.
Parameters scales_of(const Matrix& matrix) {
  Parameters scales{};
  for (std::size_t i = 0; i < parameter_count; ++i)
    scales[i] = matrix[i][i] > 0.0 ? 1.0 / std::sqrt(matrix[i][i]) : 0.0;
  return scales;
}

}  // namespace

void add_product(Matrix& matrix, double weight, const Parameters& a, const Parameters& b) {
  for (std::size_t i = 0; i < parameter_count; ++i)
    for (std::size_t j = 0; j < parameter_count; ++j) matrix[i][j] += weight * a[i] * b[j];
}

Matrix scaled(const Matrix& matrix, double factor) {
  Matrix result = matrix;
  for (Parameters& row : result)
    for (double& value : row) value *= factor;
  return result;
}

Matrix inverse(const Matrix& matrix) {
  using Square = Eigen::Matrix<double, parameter_count, parameter_count, Eigen::RowMajor>;
  using Diagonal = Eigen::Map<const Eigen::Matrix<double, parameter_count, 1>>;
  const Parameters scales = scales_of(matrix);
  const auto scale = Diagonal(scales.data()).asDiagonal();
  const Square scaled = scale * Eigen::Map<const Square>(matrix.front().data()) * scale;
  Matrix inverted{};
  Eigen::Map<Square>(inverted.front().data()) = scale * scaled.inverse() * scale;
  return inverted;
}

Parameters product(const Matrix& matrix, const Parameters& vector) {
  Parameters result{};
  for (std::size_t i = 0; i < parameter_count; ++i)
    for (std::size_t j = 0; j < parameter_count; ++j) result[i] += matrix[i][j] * vector[j];
  return result;
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (std::size_t i = 0; i < parameter_count; ++i)
    for (std::size_t k = 0; k < parameter_count; ++k)
      for (std::size_t j = 0; j < parameter_count; ++j) result[i][j] += a[i][k] * b[k][j];
  return result;
}

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#include "normal_equations.h"

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

void eliminate(Matrix& rest, Matrix& inverted, std::size_t pivot) {
  const double by = 1.0 / rest[pivot][pivot];
  for (std::size_t j = 0; j < parameter_count; ++j) {
    rest[pivot][j] *= by;
    inverted[pivot][j] *= by;
  }
  for (std::size_t i = 0; i < parameter_count; ++i) {
    const double factor = rest[i][pivot];
    if (i == pivot || factor == 0.0) continue;
    for (std::size_t j = 0; j < parameter_count; ++j) {
      rest[i][j] -= factor * rest[pivot][j];
      inverted[i][j] -= factor * inverted[pivot][j];
    }
  }
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
  const Parameters scales = scales_of(matrix);
  Matrix rest{};
  Matrix inverted{};
  for (std::size_t i = 0; i < parameter_count; ++i) {
    inverted[i][i] = 1.0;
    for (std::size_t j = 0; j < parameter_count; ++j) rest[i][j] = scales[i] * matrix[i][j] * scales[j];
  }
  for (std::size_t pivot = 0; pivot < parameter_count; ++pivot) eliminate(rest, inverted, pivot);
  for (std::size_t i = 0; i < parameter_count; ++i)
    for (std::size_t j = 0; j < parameter_count; ++j) inverted[i][j] *= scales[i] * scales[j];
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

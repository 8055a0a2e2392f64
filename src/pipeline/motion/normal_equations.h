// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace thermorig::motion {

/// What about the angles of the halves may differ from what stamps and gyro say.
enum Parameter : std::size_t {
  offset_s = 0,         // the camera is so much later than its stamps say
  bias_dps = 1,         // of the gyro, in the middle of the halves
  drift_dps_per_s = 2,  // of that bias
  scale = 3,            // gyro's rate per true rate
  parameter_count = 4
};
using Parameters = std::array<double, parameter_count>;
using Matrix = std::array<Parameters, parameter_count>;

/// matrix += weight * a * b transposed
void add_product(Matrix& matrix, double weight, const Parameters& a, const Parameters& b);

Matrix scaled(const Matrix& matrix, double factor);

/// Inverse of a symmetric positive definite matrix (priors on the diagonal keep it so).
Matrix inverse(const Matrix& matrix);

Parameters product(const Matrix& matrix, const Parameters& vector);
Matrix product(const Matrix& a, const Matrix& b);

}  // namespace thermorig::motion

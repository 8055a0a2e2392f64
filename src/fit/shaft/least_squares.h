// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace thermorig::fit {

/// Normal equations of a weighted linear least-squares problem of a few unknowns.
class LeastSquares {
 public:
  explicit LeastSquares(std::size_t unknowns)
      : size_(unknowns), matrix_(unknowns * unknowns), right_(unknowns) {}

  /// One observation: sum of row[i] * x[i] = value, with standard deviation `deviation` > 0.
  void add(std::span<const double> row, double value, double deviation);

  /// The same for a row of which only row[first .. first + row.size()) is not zero.
  void add_part(std::size_t first, std::span<const double> row, double value, double deviation);

  /// x[unknown] = value, give or take `deviation`.
  void add_prior(std::size_t unknown, double value, double deviation);

  /// The solution. Every unknown must have met an observation or a prior.
  std::vector<double> solve() const;

  /// Variance of the sum of weights[i] * x[i].
  double variance(std::span<const double> weights) const;

 private:
  std::vector<double> solve_for(std::vector<double> right) const;

  std::size_t size_;
  std::vector<double> matrix_;  // its lower triangle: it is symmetric
  std::vector<double> right_;
};

}  // namespace thermorig::fit

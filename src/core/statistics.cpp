// SPDX-License-Identifier: MIT
#include "thermorig/core/statistics.h"

#include <limits>

#include "thermorig/core/estimate.h"

namespace thermorig {

double median(std::vector<double> values) {
  return reordering_median(values);
}

double robust_deviation(std::vector<double> values, double centre) {
  constexpr double of_normal = 1.4826;
  for (double& value : values) value = std::abs(value - centre);
  return of_normal * reordering_median(values);
}

Estimate weighted_mean(std::span<const Estimate> estimates) {
  double certainty = 0.0, sum = 0.0, chi_square = 0.0;
  for (const Estimate& one : estimates) {
    certainty += 1.0 / (one.uncertainty * one.uncertainty);
    sum += one.value / (one.uncertainty * one.uncertainty);
  }
  const double mean = sum / certainty;
  for (const Estimate& one : estimates) chi_square += std::pow((one.value - mean) / one.uncertainty, 2);
  const double freedom = std::max(1.0, static_cast<double>(estimates.size()) - 1.0);
  return {mean, std::sqrt(std::max(1.0, chi_square / freedom) / certainty)};
}

double quantile(std::span<const double> sorted, double share) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace thermorig

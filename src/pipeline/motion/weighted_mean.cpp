// SPDX-License-Identifier: MIT
#include "weighted_mean.h"

#include <algorithm>
#include <cmath>

namespace thermorig::motion {

Estimate weighted_mean(std::span<const Estimate> estimates) {
  double certainty = 0.0;
  double sum = 0.0;
  for (const Estimate& one : estimates) {
    certainty += 1.0 / (one.uncertainty * one.uncertainty);
    sum += one.value / (one.uncertainty * one.uncertainty);
  }
  const double mean = sum / certainty;
  double chi_square = 0.0;
  for (const Estimate& one : estimates) chi_square += std::pow((one.value - mean) / one.uncertainty, 2);
  const double freedom = std::max(1.0, static_cast<double>(estimates.size()) - 1.0);
  return {mean, std::sqrt(std::max(1.0, chi_square / freedom) / certainty)};
}

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#include "thermorig/labels/median.h"

#include <algorithm>
#include <cmath>

namespace thermorig::labels {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double robust_deviation(std::vector<double> values, double centre) {
  constexpr double of_normal = 1.4826;
  for (double& value : values) value = std::abs(value - centre);
  return of_normal * median(std::move(values));
}

}  // namespace thermorig::labels

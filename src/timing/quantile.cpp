// SPDX-License-Identifier: MIT
#include "quantile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thermorig::timing {

namespace {
double value_at(std::vector<double>& values, double place) {
  const auto index = static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}
}  // namespace

double quantile(std::vector<double>& values, double share) {
  return values.empty() ? 0.0 : value_at(values, std::floor(share * static_cast<double>(values.size() - 1)));
}

double upper_quantile(std::vector<double>& values, double share) {
  return values.empty() ? 0.0 : value_at(values, std::ceil(share * static_cast<double>(values.size() - 1)));
}

}  // namespace thermorig::timing

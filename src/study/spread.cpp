// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"
#include "thermorig/study/evaluation.h"

namespace thermorig::study {

Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.75) - quantile(values, 0.25)};
}

}  // namespace thermorig::study

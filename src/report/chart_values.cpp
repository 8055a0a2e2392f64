// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "sections.h"

namespace thermorig::report {

std::string series_key(study::Estimator estimator) {
  switch (estimator) {
    case study::Estimator::thermal:
      return "thermal";
    case study::Estimator::fusion:
      return "fusion";
    case study::Estimator::gyro:
      return "gyro";
    case study::Estimator::gyro_unbiased:
      break;
  }
  return "gyro_unbiased";
}

nlohmann::json drawn(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

nlohmann::json drawn(const std::vector<double>& values) {
  auto array = nlohmann::json::array();
  for (const double value : values) array.push_back(drawn(value));
  return array;
}

}  // namespace thermorig::report

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "sections.h"

namespace thermorig::report {

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

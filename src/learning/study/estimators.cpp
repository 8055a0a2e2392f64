// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/estimators.h"

#include <algorithm>
#include <cassert>

#include "thermorig/estimators/table.h"

namespace thermorig::study {

namespace {

constexpr std::size_t networks = 3;

std::vector<std::string> compared() {
  std::vector<std::string> names{std::string(thermal_name), std::string(fusion_name),
                                 std::string(kalman_fusion_name)};
  for (const estimators::Entry& entry : estimators::all_entries())
    if (!entry.needs_network) names.emplace_back(entry.name);
  return names;
}

}  // namespace

std::span<const std::string> all_estimators() {
  static const std::vector<std::string> names = compared();
  return names;
}

std::span<const std::string> baselines() {
  return all_estimators().subspan(networks);
}

std::size_t place_of(std::string_view name) {
  const auto names = all_estimators();
  const auto found = std::find(names.begin(), names.end(), name);
  assert(found != names.end());
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace thermorig::study

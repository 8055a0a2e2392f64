// SPDX-License-Identifier: MIT
#include "thermorig/estimators/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "entries.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"

namespace thermorig::estimators {

std::span<const Entry> all_entries() {
  static const std::array table{gyro(),       gyro_rest(),          gyro_kalman(),
                                odometer(),   thermal_likelihood(), cnn_thermal(),
                                cnn_fusion(), cnn_fusion_kalman()};
  return table;
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const Entry& entry : all_entries()) names.emplace_back(entry.name);
  return names;
}

const Entry& entry(std::string_view name) {
  const auto table = all_entries();
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Entry& one) { return one.name == name; });
  if (found != table.end()) return *found;
  throw Error(ExitCode::bad_usage, fmt::format("the estimator \"{}\" is not known", name), "the estimator",
              advice_on_name(name, names()));
}

std::vector<std::string> names_for(const std::optional<model::Model>& model) {
  std::vector<std::string> names;
  for (const Entry& entry : all_entries()) {
    const bool has_network = model || !entry.needs_network;
    const bool has_fusion = !entry.needs_fusion || (model && model->weights.shape.fusion);
    const bool has_sigma = !entry.needs_sigma || (model && model->scaling.gate_states_sigma);
    if (has_network && has_fusion && has_sigma) names.emplace_back(entry.name);
  }
  return names;
}

}  // namespace thermorig::estimators

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

std::optional<Lack> lack_of(const Entry& entry, const std::optional<model::Model>& model) {
  if (entry.needs_network && !model) return Lack{"a network", "--model FILE"};
  if (entry.needs_fusion && (!model || !model->weights.shape.fusion))
    return Lack{"a network with fusion, and the model has none",
                "a model that was trained with fusion, or \"cnn-thermal\""};
  if (entry.needs_sigma && (!model || !model->scaling.gate_states_sigma))
    return Lack{"a network that says how sure its images are",
                "a model of preset best with fusion, or \"cnn-fusion\""};
  return std::nullopt;
}

std::vector<std::string> names_for(const std::optional<model::Model>& model) {
  std::vector<std::string> names;
  for (const Entry& entry : all_entries()) {
    if (!lack_of(entry, model)) names.emplace_back(entry.name);
  }
  return names;
}

}  // namespace thermorig::estimators

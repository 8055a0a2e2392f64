// SPDX-License-Identifier: MIT
#include "thermorig/core/label.h"

#include <algorithm>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"

namespace thermorig {

std::string_view name_of(Label label) {
  return label_names.at(static_cast<std::size_t>(label));
}

std::string column_of(Label label) {
  return "rate_" + std::string(name_of(label));
}

std::optional<Label> find_label(std::string_view name) {
  const auto found = std::find(label_names.begin(), label_names.end(), name);
  if (found == label_names.end()) return std::nullopt;
  return static_cast<Label>(found - label_names.begin());
}

Label label_named(std::string_view name) {
  if (const auto label = find_label(name)) return *label;
  const std::vector<std::string> names(label_names.begin(), label_names.end());
  throw Error(ExitCode::bad_usage, "there is no label \"" + std::string(name) + "\"", "",
              advice_on_name(name, names));
}

}  // namespace thermorig

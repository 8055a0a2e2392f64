// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"

namespace thermorig::sensors {

template <typename Protocol>
std::vector<std::string> names_in(std::span<const Protocol> table) {
  std::vector<std::string> names;
  for (const Protocol& protocol : table) names.emplace_back(protocol.name);
  return names;
}

/// Nothing if there is none of that name.
template <typename Protocol>
const Protocol* find_in(std::span<const Protocol> table, std::string_view name) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Protocol& protocol) { return protocol.name == name; });
  return found == table.end() ? nullptr : &*found;
}

/// Throws Error(bad_usage) if there is none of that name. `role`: whose table it is, in words.
template <typename Protocol>
const Protocol& required_in(std::span<const Protocol> table, std::string_view name, std::string_view role) {
  if (const Protocol* found = find_in(table, name)) return *found;
  throw Error(ExitCode::bad_usage, fmt::format("the {} protocol \"{}\" is not known", role, name),
              fmt::format("the {}'s protocol", role), advice_on_name(std::string(name), names_in(table)));
}

}  // namespace thermorig::sensors

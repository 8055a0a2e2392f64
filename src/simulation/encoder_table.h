// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::simulation {

/// Throws Error(bad_usage) if there is none of that name. `role`: whose table it is, in words.
template <typename Encoder>
const Encoder& encoder_named(std::span<const Encoder> table, const std::string& name, const char* role) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Encoder& encoder) { return encoder.name == name; });
  if (found != table.end()) return *found;
  throw Error(ExitCode::bad_usage, fmt::format("the simulated {} does not speak \"{}\"", role, name),
              fmt::format("the {}'s protocol", role), "one that `thermorig decode --help` lists");
}

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include "simulation_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "thermorig/core/printable.h"

namespace thermorig::app {

namespace {
constexpr std::ptrdiff_t shown_knobs = 3;
}  // namespace

/// A world comes last, and each of its knobs is ",group.name=value" without a blank.
std::string simulation_text(std::string_view simulation) {
  const std::string_view world = simulation.substr(simulation.rfind(' ') + 1);
  const auto knobs = std::count(world.begin(), world.end(), '=');
  if (knobs <= shown_knobs) return printable(simulation);
  const std::string_view before = simulation.substr(0, simulation.size() - world.size());
  return printable(fmt::format("{}{} ({} knobs)", before, world.substr(0, world.find(',')), knobs));
}

std::string simulated_line(std::optional<std::uint64_t> seed, std::string_view simulation) {
  return fmt::format("SIMULATED rig{}: {}\n", seed ? fmt::format(", seed {}", *seed) : "",
                     simulation_text(simulation));
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

enum class KnobScale : std::uint8_t {
  linear,
  log,  // the range spans decades: drawn evenly in its logarithm
};

/// In which worlds a knob is not honest.
enum class Comes : std::uint8_t {
  always,      // drawn for every rig
  by_chance,   // some rigs or recordings have it
  when_named,  // a mistake of whoever built the rig or wrote its profile: never drawn
};

/// One effect of a world: a number, and what there is to know about it.
struct Knob {
  std::string_view name;  // device.effect
  double& (*of)(World& world);
  std::string_view unit;    // empty: a share
  double low, high;         // both included
  std::string_view source;  // of the range
  std::string_view help;
  KnobScale scale = KnobScale::linear;
  Comes comes = Comes::always;

  double value(World world) const { return of(world); }
  double honest() const { return value(World{}); }
};

/// All there are, in the order of docs/worlds.md.
std::span<const Knob> world_knobs();

}  // namespace thermorig::simulation

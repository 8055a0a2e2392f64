// SPDX-License-Identifier: MIT
#include "thermorig/simulation/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "random.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "world_knobs.h"

namespace thermorig::simulation {
namespace {

/// How a world's knobs are drawn.
struct WorldKind {
  std::string_view name;
  double share = 0.0;   // of each range, about its middle
  double chance = 0.0;  // of an effect that comes by chance
};

constexpr std::array world_kinds{WorldKind{"honest"}, WorldKind{"typical", 1.0 / 3.0, 0.1},
                                 WorldKind{"hard", 1.0, 0.5}};

[[noreturn]] void refuse_world(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "--world", advice);
}

/// Of `table` by its name; `what`: what it is a table of.
template <typename Table>
const auto& entry_named(const Table& table, std::string_view name, const char* what) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.name == name; });
  if (found != table.end()) return *found;
  std::vector<std::string> names;
  for (const auto& entry : table) names.emplace_back(entry.name);
  refuse_world(fmt::format("the simulated rig has no {} \"{}\"", what, name), advice_on_name(name, names));
}

std::optional<double> number_of(std::string_view text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || at != end) return std::nullopt;
  return number;
}

/// Four significant digits, so that a world can be written down and read again.
double rounded(double value) {
  return number_of(fmt::format("{:.4g}", value)).value();
}

double drawn(const Knob& knob, const WorldKind& kind, std::uint64_t seed) {
  Random random(seed, std::string("world ").append(knob.name));
  const bool comes = random.chance(kind.chance);
  const double part = 0.5 + kind.share * (random.uniform() - 0.5);  // of the range
  if (knob.comes == Comes::when_named || (knob.comes == Comes::by_chance && !comes)) return knob.honest();
  const double value = knob.scale == KnobScale::log ? knob.low * std::pow(knob.high / knob.low, part)
                                                    : std::lerp(knob.low, knob.high, part);
  return std::clamp(rounded(value), knob.low, knob.high);
}

/// `setting`: name=value.
void set_knob(World& world, std::string_view setting) {
  const std::size_t equals = setting.find('=');
  const Knob& knob = entry_named(world_knobs(), setting.substr(0, equals), "knob");
  const auto range =
      fmt::format("a number from {} to {}{}{}", knob.low, knob.high, knob.unit.empty() ? "" : " ", knob.unit);
  const std::string_view text = equals == std::string_view::npos ? "" : setting.substr(equals + 1);
  const auto value = number_of(text);
  if (!value || !(*value >= knob.low && *value <= knob.high))
    refuse_world(fmt::format("\"{}\" is not a value of {}", text, knob.name), range);
  knob.of(world) = *value;
}

}  // namespace

World world_named(std::string_view text, std::uint64_t seed) {
  std::size_t end = std::min(text.find(','), text.size());
  const WorldKind& kind = entry_named(world_kinds, text.substr(0, end), "world");
  World world{.name = std::string(kind.name)};
  if (kind.share > 0.0)
    for (const Knob& knob : world_knobs()) knob.of(world) = drawn(knob, kind, seed);
  while (end < text.size()) {
    const std::size_t begin = end + 1;
    end = std::min(text.find(',', begin), text.size());
    set_knob(world, text.substr(begin, end - begin));
  }
  return world;
}

std::string text_of(const World& world) {
  std::string text = world.name;
  for (const Knob& knob : world_knobs())
    if (knob.value(world) != knob.honest()) text += fmt::format(",{}={}", knob.name, knob.value(world));
  return text;
}

}  // namespace thermorig::simulation

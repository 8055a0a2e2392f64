// SPDX-License-Identifier: MIT
// docs/worlds.md is held against the one list of knobs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "simulation/world_knobs.h"

namespace thermorig::simulation {
namespace {

std::string row_of(const Knob& knob) {
  std::string range = fmt::format("{} to {}", knob.low, knob.high);
  if (knob.scale == KnobScale::log) range += ", log";
  if (knob.comes == Comes::by_chance) range += ", by chance";
  if (knob.comes == Comes::when_named) range += ", when named";
  return fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", knob.name, knob.unit, knob.honest(), range,
                     knob.help, knob.source);
}

std::string tables() {
  std::string text, device;
  for (const Knob& knob : world_knobs()) {
    const std::string of(knob.name.substr(0, knob.name.find('.')));
    if (of != device)
      text += fmt::format(
          "\n## `{}`\n\n| knob | unit | honest | range | what it does | source of the range |\n"
          "| --- | --- | --- | --- | --- | --- |\n",
          of);
    device = of;
    text += row_of(knob);
  }
  return text;
}

TEST(WorldKnobs, AreThoseOfTheDocuments) {
  std::ifstream file(THERMORIG_SOURCE_DIR "/docs/worlds.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_THAT(page.str(), testing::HasSubstr(tables()))
      << "docs/worlds.md should have, from its second heading of the second level on:\n"
      << tables();
}

}  // namespace
}  // namespace thermorig::simulation

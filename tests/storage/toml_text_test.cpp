// SPDX-License-Identifier: MIT
// What the parser gets of a TOML text. For each value it looks through the whole line: so no line may grow
// with a list, whatever the list's length.
#include "thermorig/rig/profile/toml_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace thermorig::rig {
namespace {

std::string list_of(int numbers) {
  std::string text = "magnitudes_dps = [7.5";
  for (int i = 1; i < numbers; ++i) text += ", 7.5";
  return text + "]\nseed = 3\n";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What finding both ends of a value's line costs, over all values, in bytes.
std::size_t cost(const std::string& text) {
  std::size_t bytes = 0;
  for (const std::string& line : lines_of(text))
    bytes += line.size() * static_cast<std::size_t>(1 + std::count(line.begin(), line.end(), ','));
  return bytes;
}

TEST(TomlText, CostsTwiceAsMuchForAListOfTwiceTheLength) {
  const std::size_t once = cost(prepared_toml(list_of(10'000), "a.toml").text);
  const std::size_t twice = cost(prepared_toml(list_of(20'000), "a.toml").text);
  EXPECT_LT(twice, once * 21 / 10);
}

TEST(TomlText, KnowsWhichLineOfTheFileEachLineIs) {
  const TomlText prepared = prepared_toml(list_of(100), "a.toml");
  const std::vector<std::string> lines = lines_of(prepared.text);
  ASSERT_GT(lines.size(), 4U);
  ASSERT_EQ(lines.back(), "seed = 3");
  EXPECT_EQ(prepared.lines[0], 1U);
  EXPECT_EQ(prepared.lines[lines.size() - 2], 1U);
  EXPECT_EQ(prepared.lines[lines.size() - 1], 2U);
}

TEST(TomlText, LeavesTextsAndShortListsAsTheyAre) {
  for (const std::string text :
       {"a = [1, 2]\n", "a = \"x, y, z\" # [1, 2\n", "a = '''\n,[\n'''\nb = {c = 1, d = 2}\n"})
    EXPECT_EQ(prepared_toml(text, "a.toml").text, text);
  const std::string long_text = "a = [\"" + std::string(200, ',') + "\"]\n";
  EXPECT_EQ(prepared_toml(long_text, "a.toml").text, long_text);
}

}  // namespace
}  // namespace thermorig::rig

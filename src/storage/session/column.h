// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

namespace thermorig::session {

/// CF flags of a column: `flag_values` (one of) or `flag_masks` (any of), and what they are called.
struct Flags {
  enum class Kind : std::uint8_t { none, values, masks };
  Kind kind = Kind::none;
  std::vector<std::uint32_t> values;
  std::vector<std::string_view> meanings;  // words, in the order of `values`
};

inline Flags flag_values(std::span<const std::string_view> meanings) {
  Flags flags{Flags::Kind::values, {}, {meanings.begin(), meanings.end()}};
  for (std::uint32_t i = 0; i < meanings.size(); ++i) flags.values.push_back(i);
  return flags;
}

inline Flags flag_values(std::initializer_list<std::string_view> meanings) {
  return flag_values(std::span(meanings.begin(), meanings.size()));
}

inline Flags flag_masks(std::span<const std::string_view> meanings) {
  Flags flags{Flags::Kind::masks, {}, {meanings.begin(), meanings.end()}};
  for (std::uint32_t i = 0; i < meanings.size(); ++i) flags.values.push_back(1U << i);
  return flags;
}

inline Flags flag_masks(std::initializer_list<std::string_view> meanings) {
  return flag_masks(std::span(meanings.begin(), meanings.size()));
}

/// Name and attributes of one dataset.
struct Column {
  const char* name;
  const char* units;      // UDUNITS; "1" for counts and flags
  const char* long_name;  // with the unit in it: viewers show it instead of name and unit
  const char* description = "";
  Flags flags = {};
  const char* name_before_2 = nullptr;  // where format 1 had another
};

/// An axis within a row (row, column, x/y/z): its scale in the group.
struct InnerAxis {
  hid_t scale = -1;
  std::uint64_t size = 0;
};

inline constexpr std::uint64_t rows_max = 100'000'000;
inline constexpr std::uint64_t frames_max = 10'000'000;
inline constexpr std::uint64_t raw_bytes_max = std::uint64_t{1} << 35U;

}  // namespace thermorig::session

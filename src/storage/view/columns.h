// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace thermorig::view {

/// A column as the page is told of it.
struct ColumnName {
  std::string name;       // with its unit: "shaft_dps"
  std::string_view type;  // f64, f32, u32, u16 or u8
};

/// A table as bytes, one column behind the other: of each the lowest bytes of all values, then their next
/// higher ones, up to the highest. Neighbours are alike that way, and pack well.
class Columns {
 public:
  /// Of a table with `all` rows every n-th, the first one among them; `every`: at least 1.
  Columns(std::size_t all, std::size_t every) : rows_((all + every - 1) / every), every_(every) {}

  /// `at(row)` is the value in that row of the whole table.
  template <typename Value, typename At>
  void add(std::string name, At at) {
    names_.push_back({std::move(name), type_of<Value>()});
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + rows_ * sizeof(Value));
    for (std::size_t row = 0; row < rows_; ++row) {
      const Value value = at(row * every_);
      std::array<char, sizeof(Value)> parts{};
      std::memcpy(parts.data(), &value, sizeof value);
      for (std::size_t i = 0; i < sizeof(Value); ++i) bytes_[begin + i * rows_ + row] = parts[i];
    }
  }

  std::size_t rows() const { return rows_; }
  std::size_t every() const { return every_; }
  const std::vector<ColumnName>& names() const { return names_; }
  const std::string& bytes() const { return bytes_; }

 private:
  template <typename Value>
  static constexpr std::string_view type_of() {
    static_assert(std::endian::native == std::endian::little);
    if constexpr (std::is_same_v<Value, double>) return "f64";
    if constexpr (std::is_same_v<Value, float>) return "f32";
    if constexpr (std::is_same_v<Value, std::uint32_t>) return "u32";
    if constexpr (std::is_same_v<Value, std::uint16_t>) return "u16";
    if constexpr (std::is_same_v<Value, std::uint8_t>) return "u8";
  }

  std::size_t rows_, every_;
  std::vector<ColumnName> names_;
  std::string bytes_;
};

}  // namespace thermorig::view

// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <concepts>
#include <cstring>
#include <string>

namespace thermorig::interchange {

static_assert(std::endian::native == std::endian::little, "these formats are little-endian, and so are we");

/// Appends numbers as they lie in memory.
template <typename... Numbers>
void append_little_endian(std::string& bytes, Numbers... numbers) {
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof(numbers)), ...);
}

}  // namespace thermorig::interchange

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace thermorig::journal {

/// Writes `value` at `at`, lowest byte first. Integers of any size.
template <typename Integer>
void put_little_endian(std::uint8_t* at, Integer value) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (std::size_t i = 0; i < sizeof(Integer); ++i) at[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <typename Integer>
Integer get_little_endian(const std::uint8_t* at) {
  std::make_unsigned_t<Integer> bits = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i)
    bits = static_cast<std::make_unsigned_t<Integer>>(
        bits | static_cast<std::make_unsigned_t<Integer>>(static_cast<std::uint64_t>(at[i]) << (8 * i)));
  return static_cast<Integer>(bits);
}

}  // namespace thermorig::journal

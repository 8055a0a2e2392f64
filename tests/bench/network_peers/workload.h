// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace thermorig::bench {

// The same for every worker; pytorch.py repeats them.
inline constexpr std::uint64_t seed = 100;
inline constexpr std::size_t windows = 8;  // that inference goes through in turn
inline constexpr std::size_t batch = 32;   // of a training step

}  // namespace thermorig::bench

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig::bench {

/// How often this process has asked the C library for memory (new, malloc, calloc, realloc, aligned ones),
/// from whichever library the request came.
std::uint64_t allocations();

}  // namespace thermorig::bench

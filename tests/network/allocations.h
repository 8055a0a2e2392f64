// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

/// How often this program has asked for memory with new, on all threads.
std::size_t allocations();

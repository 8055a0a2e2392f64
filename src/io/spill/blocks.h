// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig::spill {

/// Whether a block of so many bytes is for map_block(): since arrays_near().
bool is_large(std::size_t bytes);

/// A block of memory, from a file where there are many. Nothing where the system has no such memory.
void* map_block(std::size_t bytes);

/// False for what map_block() did not give.
bool unmap_block(void* at);

}  // namespace thermorig::spill

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>

#include "thermorig/io/spill/spill.h"

namespace thermorig::session {

/// Calls `part(first, rows, at)` for rows `first` .. `first + rows - 1`, whose bytes begin at `at`, some at a
/// time. In between, pages of large arrays are given back: a column goes through an array of rows, of which
/// even a column of bytes brings all pages into memory, 3 kB a frame.
template <typename Byte, typename Part>
void in_parts(std::size_t first, std::size_t rows, Byte* at, std::size_t row_bytes, const Part& part) {
  constexpr std::size_t part_rows = 1024;
  for (std::size_t row = 0; row < rows; row += part_rows) {
    part(first + row, std::min(part_rows, rows - row), at + row * row_bytes);
    spill::give_pages_back();
  }
}

}  // namespace thermorig::session

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "thermorig/core/profile.h"
#include "thermorig/core/reading.h"

namespace thermorig::sensors {

/// What one line of a text gyro says.
struct TextLine {
  bool is_sample = false;  // it was meant as a sample: it has the prefix, or a number in a wanted column
  std::size_t fields = 0;
  std::optional<GyroReading> reading;  // none if a wanted column is missing, unreadable or not finite
};

/// Reads a line without its line end. `room` is kept from line to line, so that none costs an allocation.
/// Source: protocols/text_gyro.md.
TextLine read_text_line(const TextColumns& columns, std::string_view line, std::string& room);

/// Whether the sum at the end of a line is one of those below; none: it ends with no sum.
std::optional<bool> has_right_sum(std::string_view line);

/// What some devices end their lines with: "*5A", the XOR or the sum of the characters before it (behind a
/// "$", where there is one). Which of them it is, or that it is neither, no line says: two that fit in a row
/// do.
class LineSum {
 public:
  /// Whether the line is damaged by its sum; `line`: each sample's, without its end.
  bool is_wrong(std::string_view line);

 private:
  std::array<int, 2> fitted_{};  // in a row, as the one and as the other
  std::optional<std::size_t> kind_;
};

}  // namespace thermorig::sensors

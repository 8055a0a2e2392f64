// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
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

}  // namespace thermorig::sensors

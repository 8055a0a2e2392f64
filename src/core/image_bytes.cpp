// SPDX-License-Identifier: MIT
#include "thermorig/core/image_bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig {

namespace {

std::int16_t pixel_hundredths(float temp_c) {
  constexpr double limit = std::numeric_limits<std::int16_t>::max();
  if (!std::isfinite(temp_c)) return std::numeric_limits<std::int16_t>::min();
  return static_cast<std::int16_t>(std::clamp(std::round(100.0 * double{temp_c}), -limit, limit));
}

}  // namespace

void append_hundredths(std::vector<std::uint8_t>& bytes, float temp_c) {
  const auto value = static_cast<std::uint16_t>(pixel_hundredths(temp_c));
  bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

void append_image(std::vector<std::uint8_t>& bytes, const ThermalFrame& frame, bool mirrored) {
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column) {
      const std::size_t from = mirrored ? frame_columns - 1 - column : column;
      append_hundredths(bytes, frame.temp_c[row * frame_columns + from]);
    }
}

}  // namespace thermorig

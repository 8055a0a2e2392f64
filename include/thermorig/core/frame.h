// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace thermorig {

inline constexpr std::size_t frame_rows = 24;
inline constexpr std::size_t frame_columns = 32;
inline constexpr std::size_t frame_pixels = frame_rows * frame_columns;

/// Chess subpage of a pixel of the MLX90640: 0 (even) or 1 (odd). Source: data sheet, "Reading patterns".
constexpr unsigned subpage_of(std::size_t row, std::size_t column) {
  return static_cast<unsigned>((row ^ column) & 1U);
}

/// Within the sensor's range; false for NaN.
constexpr bool is_temperature(float temp_c) {
  constexpr float coldest_c = -60.0F, hottest_c = 400.0F;
  return static_cast<unsigned>(temp_c >= coldest_c) & static_cast<unsigned>(temp_c <= hottest_c);
}

/// One thermal image in the order in which the sensor sends it (a mirror image of the scene: see
/// `CameraProfile::mirrored`). What the bridge sends is kept as it is; nothing is repaired here.
struct ThermalFrame {
  std::array<float, frame_pixels> temp_c{};  // (24 rows, 32 columns), row-major, degrees Celsius
  float sensor_temp_c = 0.0F;                // the sensor's own temperature (Ta)
};

}  // namespace thermorig

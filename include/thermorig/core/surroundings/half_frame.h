// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "thermorig/core/frame.h"
#include "thermorig/core/sample.h"

namespace thermorig {

inline constexpr std::size_t half_rows = frame_rows / 2;  // pixels of one column in one chess half
inline constexpr std::size_t half_pixels = frame_pixels / 2;

/// A value for each pixel of a chess half, column after column (32, 12): what lies in one column looks into
/// one direction, and inner loops run over neighbours in memory. Aligned for vectors of four.
struct alignas(16) HalfPixels : std::array<float, half_pixels> {};

/// Of the two classes of rows, even and odd, the one that a column of a chess half has.
constexpr std::size_t row_class(std::size_t column, unsigned parity) {
  return (column ^ parity) & 1U;
}

/// The row in the frame of the k-th pixel of a column.
constexpr std::size_t row_of(std::size_t column, std::size_t k, unsigned parity) {
  return 2 * k + row_class(column, parity);
}

/// Its temperatures, degrees Celsius; NaN where there is no reading of the sensor's range.
HalfPixels pixels_of(const ThermalFrame& frame, unsigned parity);

/// A chess half that was read anew.
struct HalfFrame {
  HalfPixels temp_c{};  // NaN: no reading
  unsigned parity = 0;
  double begin_s = 0.0, end_s = 0.0;  // of its exposure by the camera's stamps
  double time_sigma_s = 0.0;          // of those
};

/// The chess half of a frame, if it was read anew and its time is known. Seconds since `origin`.
std::optional<HalfFrame> half_of(const TimedFrame& frame, unsigned parity, HostTime origin);

/// Mean of those that are known; 0 of none.
float mean_of(const HalfPixels& pixels);

inline constexpr double whole_turn_deg = 360.0;

/// Which share of a whole turn an azimuth is, 0 to 1. Asked of each pixel again and again: std::floor is
/// slower.
inline double share_of_turn(double azimuth_deg) {
  const double turns = azimuth_deg * (1.0 / whole_turn_deg);
  const auto whole = static_cast<double>(static_cast<std::int64_t>(turns));
  return turns - (whole > turns ? whole - 1.0 : whole);
}

constexpr double square(double value) {
  return value * value;
}

}  // namespace thermorig

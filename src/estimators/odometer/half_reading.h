// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "thermorig/core/frame.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::odometer {

inline constexpr std::size_t half_rows = frame_rows / 2;  // pixels of one column in one chess half
inline constexpr std::size_t half_pixels = frame_pixels / 2;
inline constexpr double whole_turn_deg = 360.0;

constexpr double square(double value) {
  return value * value;
}

/// Which share of a whole turn an azimuth is, 0 to 1. Asked of each pixel again and again: std::floor is
/// slower.
inline double share_of_turn(double azimuth_deg) {
  const double turns = azimuth_deg * (1.0 / whole_turn_deg);
  const auto whole = static_cast<double>(static_cast<std::int64_t>(turns));
  return turns - (whole > turns ? whole - 1.0 : whole);
}

/// A value for each pixel of a chess half, column after column (32, 12): what lies in one column looks into
/// one direction, and inner loops run over neighbours in memory.
using HalfPixels = std::array<float, half_pixels>;

/// Of the two classes of rows, even and odd, the one that a column of a chess half has.
constexpr std::size_t row_class(std::size_t column, unsigned parity) {
  return (column ^ parity) & 1U;
}

/// What the gyro turned by while a chess half was exposed, bias and scale not removed: enough to know the
/// mean heading and its spread for any bias and scale. Times in seconds of the gyro's path.
struct ExposedTurn {
  double begin_s = 0.0, end_s = 0.0;
  double begin_deg = 0.0, end_deg = 0.0;  // integral of the readings
  double mean_s = 0.0, mean_deg = 0.0;    // over the exposure
  double variance_s2 = 0.0, variance_deg2 = 0.0, covariance = 0.0;
  double change_dps = 0.0;                 // of the reading, from the first third to the last
  double first_dps = 0.0, last_dps = 0.0;  // readings at both ends

  double length_s() const { return end_s - begin_s; }
  double mean_read_dps() const { return (end_deg - begin_deg) / length_s(); }
};

/// Where each row looks and how far it sweeps, if rows are exposed one after the other: rows from the top.
struct RowSweeps {
  std::array<float, frame_rows> shift_deg{};  // against the middle of the frame
  std::array<float, frame_rows> half_width_deg{};
};

/// A chess half that was read anew.
struct HalfReading {
  HalfPixels temp_c{};  // NaN: no reading
  unsigned parity = 0;
  double begin_s = 0.0, end_s = 0.0;  // of its exposure by the camera's stamps
  double time_sigma_s = 0.0;          // of those
};

/// The row in the frame of the k-th pixel of a column.
constexpr std::size_t row_of(std::size_t column, std::size_t k, unsigned parity) {
  return 2 * k + row_class(column, parity);
}

/// The chess half of a frame, if it was read anew and its time is known. Seconds since `origin`.
std::optional<HalfReading> half_of(const TimedFrame& frame, unsigned parity, HostTime origin);

/// Of those that are known.
inline float mean_of(const HalfPixels& pixels) {
  float sum = 0.0F, count = 0.0F;
  for (const float one : pixels) {
    if (std::isnan(one)) continue;
    sum += one;
    count += 1.0F;
  }
  return count > 0.0F ? sum / count : 0.0F;
}

}  // namespace thermorig::odometer

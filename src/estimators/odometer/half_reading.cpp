// SPDX-License-Identifier: MIT
#include "half_reading.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr std::uint16_t fresh_pixels = half_pixels / 50;  // 2 %, as the detector of freshness has it
constexpr float coldest_c = -60.0F, hottest_c = 400.0F;   // beyond: not a temperature of the sensor's range
constexpr HostDuration longest_exposure = std::chrono::seconds(4);  // of a half: at 0.5 frames a second

bool is_exposure(const HalfExposure& half) {
  return half.end > half.begin && half.end - half.begin <= longest_exposure;
}

}  // namespace

std::optional<HalfReading> half_of(const TimedFrame& frame, unsigned parity, HostTime origin) {
  const bool is_timed =
      !frame.late && !frame.stale && !frame.stands_in && std::isfinite(frame.stamp.uncertainty_s);
  const bool is_fresh = (parity == 0 ? frame.fresh_even : frame.fresh_odd) > fresh_pixels;
  if (!is_timed || !is_fresh || !is_exposure(frame.half[parity])) return std::nullopt;
  HalfReading half{.parity = parity,
                   .begin_s = to_s(frame.half[parity].begin - origin),
                   .end_s = to_s(frame.half[parity].end - origin),
                   .time_sigma_s = double{frame.stamp.uncertainty_s}};
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const float temp_c = frame.frame.temp_c[row_of(column, k, parity) * frame_columns + column];
      const bool is_sound = temp_c > coldest_c && temp_c < hottest_c;  // false for NaN
      half.temp_c[column * half_rows + k] = is_sound ? temp_c : std::numeric_limits<float>::quiet_NaN();
    }
  return half;
}

}  // namespace thermorig::odometer

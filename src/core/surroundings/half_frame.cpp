// SPDX-License-Identifier: MIT
#include "thermorig/core/surroundings/half_frame.h"

#include <cmath>
#include <limits>

namespace thermorig {

HalfPixels pixels_of(const ThermalFrame& frame, unsigned parity) {
  HalfPixels pixels;
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const float temp_c = frame.temp_c[row_of(column, k, parity) * frame_columns + column];
      pixels[column * half_rows + k] =
          is_temperature(temp_c) ? temp_c : std::numeric_limits<float>::quiet_NaN();
    }
  return pixels;
}

std::optional<HalfFrame> half_of(const TimedFrame& frame, unsigned parity, HostTime origin) {
  const HalfExposure& exposure = frame.half[parity];
  const bool is_timed =
      !frame.late && !frame.stale && !frame.stands_in && std::isfinite(frame.stamp.uncertainty_s);
  if (!is_timed || !frame.is_fresh(parity) || !exposure.is_possible()) return std::nullopt;
  return HalfFrame{.temp_c = pixels_of(frame.frame, parity),
                   .parity = parity,
                   .begin_s = to_s(exposure.begin - origin),
                   .end_s = to_s(exposure.end - origin),
                   .time_sigma_s = double{frame.stamp.uncertainty_s}};
}

float mean_of(const HalfPixels& pixels) {
  float sum = 0.0F, count = 0.0F;
  for (const float one : pixels) {
    if (std::isnan(one)) continue;
    sum += one;
    count += 1.0F;
  }
  return count > 0.0F ? sum / count : 0.0F;
}

}  // namespace thermorig

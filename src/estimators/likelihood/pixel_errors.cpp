// SPDX-License-Identifier: MIT
#include "pixel_errors.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::likelihood {

namespace {

constexpr std::size_t most_unsound = frame_pixels / 16;  // of a half's 384
constexpr float stuck_after = 3.0F;                      // repeats: readings have noise
constexpr float broken_c = 2.0F;                         // of a constant error
constexpr float glitch = 7.0F;                           // of the typical difference from those about a pixel
constexpr float most_change_c = 3.0F;                    // that one half counts with
constexpr float most_halves_learnt = 300.0F, prior_halves = 15.0F;

struct Offset {
  int row, column;
};
constexpr std::array<Offset, 8> neighbours{
    {{-1, -1}, {-1, 1}, {1, -1}, {1, 1}, {-2, 0}, {2, 0}, {0, -2}, {0, 2}}};

/// Median of the nearest pixels of the same half: one that is broken does not matter.
float about(const ThermalFrame& frame, std::size_t row, std::size_t column) {
  std::array<float, neighbours.size()> sorted;
  std::size_t count = 0;
  for (const Offset& offset : neighbours) {
    const std::size_t r = row + static_cast<std::size_t>(offset.row);  // -1 wraps to beyond the last
    const std::size_t c = column + static_cast<std::size_t>(offset.column);
    if (r >= frame_rows || c >= frame_columns) continue;
    const float temp_c = frame.temp_c[r * frame_columns + c];
    if (!is_temperature(temp_c)) continue;
    std::size_t k = count++;
    for (; k > 0 && sorted[k - 1] > temp_c; --k) sorted[k] = sorted[k - 1];
    sorted[k] = temp_c;
  }
  if (count == 0) return 0.0F;
  return 0.5F * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

}  // namespace

bool PixelErrors::clean(const ThermalFrame& frame, unsigned parity, HalfLines& lines) {
  Half& half = halves_[parity];
  std::size_t i = 0, unsound = 0;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t k = 0; k < line_pixels; ++k, ++i) {
      const std::size_t column = 2 * k + ((row ^ parity) & 1U);
      const float temp_c = frame.temp_c[row * frame_columns + column];
      Pixel& pixel = half.pixels[i];
      about_c_[i] = about(frame, row, column);
      lines[row][k] = is_temperature(temp_c) ? temp_c : about_c_[i];
      unsound += is_temperature(temp_c) ? 0 : 1;
      pixel.repeats = temp_c == pixel.last_c ? pixel.repeats + 1.0F : 0.0F;
      pixel.last_c = temp_c;
      pixel.beyond_c = lines[row][k] - about_c_[i];
      sizes_[i] = std::abs(pixel.beyond_c - pixel.error_c);
    }
  if (unsound > most_unsound) return false;
  const float typical_c = reordering_median(sizes_);
  const float share = half.count / (half.count + prior_halves);
  for (i = 0; i < half.pixels.size(); ++i) {
    const Pixel& pixel = half.pixels[i];
    float& temp_c = lines[i / line_pixels][i % line_pixels];
    const bool is_broken = std::abs(pixel.error_c) > broken_c || pixel.repeats >= stuck_after ||
                           std::abs(pixel.beyond_c - pixel.error_c) > glitch * typical_c;
    temp_c = is_broken ? about_c_[i] : temp_c - share * pixel.error_c;
  }
  return true;
}

void PixelErrors::learn(unsigned parity) {
  Half& half = halves_[parity];
  half.count = std::min(half.count + 1.0F, most_halves_learnt);
  for (Pixel& pixel : half.pixels)
    pixel.error_c += std::clamp(pixel.beyond_c - pixel.error_c, -most_change_c, most_change_c) / half.count;
}

}  // namespace thermorig::likelihood

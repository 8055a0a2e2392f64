// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "thermorig/core/frame.h"

namespace thermorig {

/// How much of a frame is new, by chess half.
struct Freshness {
  std::uint16_t even = 0;  // pixels of the even half that differ from the frame before, 0..384
  std::uint16_t odd = 0;
  bool even_fresh() const { return even > threshold; }
  bool odd_fresh() const { return odd > threshold; }
  bool both_fresh() const { return even_fresh() && odd_fresh(); }
  bool one_fresh() const { return even_fresh() != odd_fresh(); }
  bool none_fresh() const { return !even_fresh() && !odd_fresh(); }
  static constexpr std::uint16_t threshold = 384 / 50;  // 2 %
};

/// Exact comparison of a frame with the one before, on its pixels as the camera sent them: what is calculated
/// from them may differ although nothing was read anew. The first frame counts as wholly fresh. Not a number
/// differs from everything.
template <typename Pixel>
class FreshnessDetector {
 public:
  using Pixels = std::span<const Pixel, frame_pixels>;

  Freshness push(Pixels pixels) {
    constexpr std::uint16_t half_pixels = frame_pixels / 2;
    const Freshness fresh = has_before_ ? compare(pixels) : Freshness{half_pixels, half_pixels};
    std::copy(pixels.begin(), pixels.end(), before_.begin());
    has_before_ = true;
    return fresh;
  }

  /// The next frame is a first one.
  void restart() { has_before_ = false; }

 private:
  Freshness compare(Pixels pixels) const {
    std::array<std::array<std::uint32_t, frame_columns>, 2> differ{};  // by row parity
    for (std::size_t row = 0; row < frame_rows; ++row)
      count_row(&pixels[row * frame_columns], &before_[row * frame_columns], differ[row & 1U]);
    std::array<std::uint16_t, 2> half{};
    for (std::size_t row = 0; row < 2; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column)
        half[subpage_of(row, column)] =
            static_cast<std::uint16_t>(half[subpage_of(row, column)] + differ[row][column]);
    return {half[0], half[1]};
  }

  /// Pixels of each column that differ, in rows of one parity. A loop that the compiler turns into vectors.
  static void count_row(const Pixel* now, const Pixel* before,
                        std::array<std::uint32_t, frame_columns>& differ) {
    for (std::size_t column = 0; column < frame_columns; ++column)
      differ[column] += now[column] != before[column] ? 1U : 0U;
  }

  std::array<Pixel, frame_pixels> before_{};
  bool has_before_ = false;
};

}  // namespace thermorig

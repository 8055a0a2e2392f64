// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>

#include "column_pixels.h"

namespace thermorig::motion {

/// What is peculiar to each pixel: its own offset and how noisy it is, by chess half.
class PixelModel {
 public:
  /// A first idea: how a pixel's mean over all angles differs from its neighbours'. Their smooth part is the
  /// surroundings, which the angles average only in part. Pixels that never change are left out for good.
  explicit PixelModel(std::span<const HalfView> views);

  /// Readings of a column without the pixels' offsets and the half's own.
  ColumnPixels values(const HalfView& view, float half_offset_c, std::size_t column) const {
    return column_of(view.temp_c, column) - column_of(offset_c_[view.half.parity], column) - half_offset_c;
  }
  /// How much each of them counts: 1 for a pixel of average noise.
  ColumnPixels weights(const HalfView& view, std::size_t column) const {
    return column_of(weight_[view.half.parity], column) * column_of(view.trust, column);
  }
  const HalfPixels& pixel_weights(unsigned parity) const { return weight_[parity]; }

  /// Weighted sums over the halves of one parity.
  struct Residuals {
    HalfPixels sum{};
    HalfPixels square{};
    HalfPixels weight{};
    void add(const HalfPixels& residual, const HalfPixels& weights);
  };
  /// Takes what is left of each pixel on average into its offset, and its spread into its weight.
  void learn(const std::array<Residuals, 2>& residuals);

 private:
  std::array<HalfPixels, 2> offset_c_{};
  std::array<HalfPixels, 2> weight_{};
};

}  // namespace thermorig::motion

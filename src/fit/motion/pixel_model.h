// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "half_view.h"

namespace thermorig::motion {

/// Of one column. Compilers unroll loops over so few before they see that they are vectors: hence Eigen.
using ColumnPixels = Eigen::Array<float, half_rows, 1>;
using ColumnOf = Eigen::Map<ColumnPixels, Eigen::Aligned16>;
using ConstColumnOf = Eigen::Map<const ColumnPixels, Eigen::Aligned16>;
inline ColumnOf column_of(HalfPixels& pixels, std::size_t column) {
  return ColumnOf(&pixels[column * half_rows]);
}
inline ConstColumnOf column_of(const HalfPixels& pixels, std::size_t column) {
  return ConstColumnOf(&pixels[column * half_rows]);
}

struct Readings {
  HalfPixels value_c;
  HalfPixels weight;  // how much each of them counts: 1 for a pixel of average noise
};

/// What is peculiar to each pixel: its own offset and how noisy it is, by half-frame.
class PixelModel {
 public:
  /// A first idea: how a pixel's mean over all angles differs from its neighbours'. Their smooth part is the
  /// surroundings, which the angles average only in part. Pixels that never change are left out for good.
  explicit PixelModel(std::span<const HalfView> views);

  /// Puts the half's readings without the pixels' offsets and its own into `readings`.
  void read(const HalfView& view, float half_offset_c, Readings& readings) const;
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

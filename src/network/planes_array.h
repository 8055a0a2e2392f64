// SPDX-License-Identifier: MIT
#pragma once

#include "aligned_array.h"
#include "kernels/training_kernels.h"

namespace thermorig::network {

/// (channels, rows, columns) cells with `margin` cells of 0 around each plane, and `spare` cells behind the
/// last.
class PlanesArray {
 public:
  PlanesArray(int channels, int rows, int columns, int margin, int spare = 0)
      : margin_(margin),
        row_(static_cast<long>(columns + 2 * margin) * cell),
        plane_(row_ * (rows + 2 * margin)),
        values_(static_cast<std::size_t>(plane_ * channels + static_cast<long>(spare) * cell)) {}

  Planes with_margin() { return {values_.data(), row_, plane_}; }
  Planes inner() { return {values_.data() + margin_ * (row_ + cell), row_, plane_}; }

 private:
  int margin_;
  long row_, plane_;
  AlignedFloats values_;
};

}  // namespace thermorig::network

// SPDX-License-Identifier: MIT
#pragma once

#include "aligned_array.h"
#include "kernels/training_kernels.h"

namespace thermorig::network {

/// (channels, rows, columns) cells with `margin` cells of 0 around each plane, and one cell behind the last.
/// Rows and planes are a few cache lines apart: at distances of 4 KiB, which are common among powers of two,
/// the rows and channels of a tile would drive each other out of the first cache.
class PlanesArray {
 public:
  PlanesArray(int channels, int rows, int columns, int margin)
      : margin_(margin),
        row_(static_cast<long>(columns + 2 * margin) * cell + row_gap),
        plane_(row_ * (rows + 2 * margin) + plane_gap),
        values_(static_cast<std::size_t>(plane_ * channels + cell)) {}

  Planes with_margin() { return {values_.data(), row_, plane_}; }
  Planes inner() { return {values_.data() + margin_ * (row_ + cell), row_, plane_}; }

  int place(int channel, int row, int column) const {  // of an inner cell, from with_margin().first on
    return static_cast<int>(channel * plane_ + (row + margin_) * row_ + (column + margin_) * long{cell});
  }
  int place_behind() const { return static_cast<int>(values_.size()) - cell; }

 private:
  static constexpr long line = 16;  // floats of a cache line
  static constexpr long row_gap = line, plane_gap = 5 * line;

  int margin_;
  long row_, plane_;
  AlignedFloats values_;
};

}  // namespace thermorig::network

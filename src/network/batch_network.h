// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "aligned_array.h"
#include "batch_layout.h"
#include "kernels/training_kernels.h"
#include "thermorig/network/batch.h"
#include "thermorig/network/instruction_set.h"

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

const TrainingKernels& training_kernels(InstructionSet set);

/// Which part of `count` things is a worker's.
struct Share {
  int worker = 0, workers = 1;
  int first(int count) const { return static_cast<int>(static_cast<long>(count) * worker / workers); }
  int last(int count) const { return static_cast<int>(static_cast<long>(count) * (worker + 1) / workers); }
};

/// Hidden units of a head, filled up to whole blocks: where the next head's begin.
inline constexpr int head_cells = (hidden1 + block - 1) / block * block;

/// The forward pass of a batch, step by step, each step in shares, and all that the backward pass needs of
/// it.
class BatchNetwork {
 public:
  BatchNetwork(const Weights& weights, InstructionSet set);

  const Shape& shape() const { return shape_; }
  const BatchLayout& layout() const { return layout_; }
  const TrainingKernels& kernels() const { return *kernels_; }
  std::span<float> weights() { return {weights_.data(), weights_.size()}; }
  std::span<const float> weights() const { return {weights_.data(), weights_.size()}; }
  float* at(std::size_t place) { return weights_.data() + place; }

  /// To be called once the convolutions' weights have changed.
  void pack_convolutions();

  // The steps; each needs all shares of the one before.
  void load(const Batch& batch, Share share);
  void convolve1(Share share);
  void convolve2(Share share);
  void dense1(Share share);
  void heads();  // the rest: one worker's

  // What came out: cells.
  PlanesArray input;       // (Nf, H, W), padded
  PlanesArray pooled;      // (6, H1 / 2, W1 / 2), padded
  AlignedFloats features;  // (16, H2, W2), filled up to whole blocks
  Choices choices() { return {choices_.data(), choice_row_, choice_plane_}; }
  AlignedFloats hidden_first;   // (heads, 128): 120 units, the rest 0
  AlignedFloats hidden_second;  // (80)
  AlignedFloats thermal, gain;  // y_th, Kg

 private:
  Shape shape_;
  BatchLayout layout_;
  const TrainingKernels* kernels_;
  AlignedFloats weights_;
  AlignedFloats conv1_weights_, conv2_weights_;  // (outputs / tile, inputs, 5, 5, tile)
  AlignedArray<int> choices_;
  long choice_row_, choice_plane_;
};

/// (outputs, inputs, 5, 5) to (outputs / tile, inputs, 5, 5, tile)
void pack_convolution(const float* weights, int outputs, int inputs, int tile, float* packed);

}  // namespace thermorig::network

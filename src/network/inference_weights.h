// SPDX-License-Identifier: MIT
#pragma once

#include "aligned_array.h"
#include "kernels/inference_kernels.h"
#include "thermorig/network/estimator.h"

namespace thermorig::network {

inline std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// A fully connected layer in the blocks that a kernel walks over.
struct InferenceDense {
  AlignedFloats weights, bias;
  AlignedArray<std::uint16_t> halves;  // instead of `weights`
  DenseLayer layer;                    // points to these

  InferenceDense(int inputs, int outputs, const InferenceKernels& kernels);

  /// Takes the outputs from `first` on from a tensor of weights (outputs, channels, pixels) and its biases;
  /// the layer's inputs are in the order (pixels, channels).
  void take(std::span<const float> weight, std::span<const float> bias, int first, int channels);
  /// To half precision, when all outputs have been taken.
  void halve(const InferenceKernels& kernels);
};

/// The weights of a network in the order in which the inference kernels of one instruction set walk over
/// them.
struct InferenceWeights {
  AlignedFloats convolution1, bias1;  // (Nf, 5, 5, 6), (6)
  AlignedFloats convolution2, bias2;  // (6, 5, 5, 16), (16)
  InferenceDense first;  // first layers of both heads as one of 240 outputs: speed, gain (thermal-only: 120);
                         // features in Conv2's order (row, column, channel)
  InferenceDense second;                // of the speed head
  AlignedFloats readout, gain_readout;  // (80), (128) of which the last 8 are 0
  float readout_bias = 0.0F, gain_readout_bias = 0.0F;

  InferenceWeights(const Weights& weights, Precision precision, const InferenceKernels& kernels);
};

}  // namespace thermorig::network

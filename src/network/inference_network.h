// SPDX-License-Identifier: MIT
#pragma once

#include "inference_weights.h"

namespace thermorig::network {

/// The forward pass of one window, step by step; all memory is taken when it is made.
class InferenceNetwork {
 public:
  InferenceNetwork(const Weights& weights, Precision precision, InstructionSet set);

  const Shape& shape() const { return shape_; }

  void load(std::span<const float> frames);  // amid zeros
  void convolve1();                          // Conv1, ReLU, max-pool
  void convolve2();                          // Conv2, ReLU
  void list_features();                      // those that are not zero: half of them or fewer
  void dense1();                             // both heads' first layers
  Output heads(float gyro);

  int listed_features() const { return listed_; }
  /// Bytes of weights that dense1 reads for one feature.
  int bytes_per_feature() const;

 private:
  Shape shape_;
  const InferenceKernels& kernels_;
  InferenceWeights weights_;
  PoolingConvolution conv1_;
  FeatureConvolution conv2_;
  AlignedFloats padded_;                // (Nf, H + 2 padding1, stride)
  AlignedFloats pooled_;                // (6, pooled_rows + 2 padding2, pooled_columns + 2 padding2)
  AlignedFloats features_;              // (rows2, columns2, 16)
  AlignedArray<std::uint16_t> places_;  // of the values that are not zero
  int listed_ = 0;
  AlignedFloats hidden_;   // (240 or 120), then zeros to a whole vector
  AlignedFloats readout_;  // (80)
};

}  // namespace thermorig::network

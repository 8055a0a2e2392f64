// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "batch_network.h"
#include "thermorig/network/trainer.h"

namespace thermorig::network {

/// What Adam does in a step: to the layers that take all features, and to all others.
struct AdamSteps {
  AdamStep others, wide;
};

/// The backward pass of a batch after its forward pass, step by step, each step in shares. Dense weights are
/// changed on the way, unless `keep_gradient` asked for their gradient; all other gradients are kept, in the
/// places of BatchLayout.
class BatchGradients {
 public:
  explicit BatchGradients(BatchNetwork& network);

  std::span<float> first_moment() { return {first_.data(), first_.size()}; }
  std::span<float> second_moment() { return {second_.data(), second_.size()}; }
  std::span<const float> gradient() const { return {gradient_.data(), gradient_.size()}; }

  /// Before a step: what Adam does in it, or nothing to have all gradients kept and no weight changed.
  void begin(const AdamSteps* adam);

  // The steps; each needs all shares of the one before.
  StepLoss heads(const Batch& batch, const LossConfig& config);  // one worker's
  void dense1(Share share);
  void convolve2_weights(Share share);  // these two may be done at the same time
  void convolve2_input(Share share);
  void convolve1(Share share);
  void change_small_tensors();  // one worker's; the weights that are not in dense layers

 private:
  DenseGradientJob dense_job(std::size_t place, AdamStep AdamSteps::*adam);
  float* gradient_at(std::size_t place) { return gradient_.data() + place; }

  BatchNetwork& network_;
  AlignedFloats gradient_, first_, second_;  // as BatchLayout
  const AdamSteps* adam_ = nullptr;

  // Gradients of activations before their ReLU: cells.
  AlignedFloats thermal_, gain_;
  AlignedFloats hidden_first_;   // (heads, 128)
  AlignedFloats hidden_second_;  // (80)
  PlanesArray features_;         // (16, H2, W2), with the margin that turns a convolution round
  PlanesArray pooled_;           // (6, H1 / 2, W1 / 2)
  AlignedFloats turned_;         // Conv2's weights turned by 180 degrees: (1, 16, 5, 5, 6)
  AlignedFloats sums1_, sums2_;  // (weights, a vector)
  std::vector<int> hidden_places_, feature_places_;
};

}  // namespace thermorig::network

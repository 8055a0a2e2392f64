// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "reference_layers.h"
#include "thermorig/network/trainer.h"

namespace thermorig::network {

struct ReferenceOutput {
  double fusion = 0.0, thermal = 0.0, gain = 1.0;
};

struct ReferenceGradients {
  StepLoss loss;
  Values values;  // in the canonical order of the weights
};

/// The paper's network (section III, Fig. 2) and its training in plain double precision: to be read beside
/// the paper, and held against by everything that is fast.
class ReferenceNetwork {
 public:
  explicit ReferenceNetwork(const Weights& weights);

  /// `frames`: (Nf, H, W), oldest first, normalised.
  ReferenceOutput forward(std::span<const float> frames, double gyro) const;

  ReferenceGradients gradients(const Batch& batch, const LossConfig& config) const;

  /// Gradients, then one step of Adam.
  StepLoss step(const Batch& batch, const LossConfig& loss, const AdamConfig& adam);

  Values& weights() { return weights_; }  // canonical order
  const Values& weights() const { return weights_; }

 private:
  struct Activations;

  Activations run(Maps frames, double gyro) const;
  void run_backward(const Activations& a, double dfusion, double dthermal, Values& gradients) const;
  const Tensor& place(std::string_view name) const;
  std::span<const double> tensor(std::string_view name) const;

  Shape shape_;
  std::vector<Tensor> tensors_;
  Values weights_;
  Values first_, second_;  // Adam's moments
  std::uint64_t steps_ = 0;
};

}  // namespace thermorig::network

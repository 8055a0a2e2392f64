// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/workers.h"

namespace thermorig::network {

/// Inverted Huber (paper eq. 3): |e| where |e| <= c, else (e^2 + c^2) / (2c), c = fraction * max |e| over the
/// batch, a constant to the gradient; mean over the batch. With all errors 0 the loss is 0.
struct LossConfig {
  float berhu_fraction = 0.2F;
  float auxiliary_thermal = 0.0F;  // weight of the same loss on y_th alone, with a c of its own; 0: the paper
  // Instead, of a network with a gate: how likely the error of y_th is, given the sigma that Kg states (see
  // gate_sigma()). Neither the gyro nor the two above take part.
  bool likelihood = false;
};

/// What a gate states of y_th that was trained with `likelihood`: Kg = g^2 / (g^2 + sigma^2) for a gyro that
/// is off by g. Both in the same unit; Kg 0..1, at its ends as far as a float tells them from what is beside.
double gate_sigma(double gain, double gyro_sigma);
/// g, of labels divided by 200 deg/s: the 10 deg/s that the paper's gyros are off.
inline constexpr double gate_gyro_sigma = 0.05;

/// Kingma & Ba 2015; the paper gives the rate 0.001, the rest are that publication's.
struct AdamConfig {
  float rate = 1e-3F;
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-8F;
  float wide_rate = 1.0F;  // of the rate, for the two layers that take all features
};

struct TrainerConfig {
  LossConfig loss;
  AdamConfig adam;
  InstructionSet set = best_instruction_set();
};

/// Adam's moments in the canonical order of the weights, and the number of steps done: all that continuing
/// needs beside the weights.
struct OptimiserState {
  std::vector<float> first, second;  // weight_count each
  std::uint64_t steps = 0;
  bool operator==(const OptimiserState&) const = default;
};

/// What one step saw, before it changed the weights.
struct StepLoss {
  double loss = 0.0;           // as trained: mean over the batch, auxiliary part included
  double squared_error = 0.0;  // mean of (y_fus - y)^2, normalised
  double gain_mean = 1.0;      // of Kg over the batch
};

/// Trains a network batch by batch: forward, backward, Adam. Results depend on weights, batches,
/// configuration and instruction set alone, not on the size of the workers.
class Trainer {
 public:
  Trainer(const Weights& weights, const TrainerConfig& config, Workers& workers);
  ~Trainer();
  Trainer(Trainer&&) noexcept;

  const Shape& shape() const;

  /// One step of Adam on 1..32 windows, at this share of its rate.
  StepLoss step(const Batch& batch, double rate_share = 1.0);

  /// Gradients of the loss in the order of the weights; changes nothing.
  std::vector<float> gradients(const Batch& batch);

  Weights weights() const;
  OptimiserState optimiser() const;
  /// Goes on from there. Sizes must fit the shape (a bug otherwise).
  void restore(const Weights& weights, const OptimiserState& optimiser);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The forward pass of many windows: for evaluation. Faster than an Estimator by far, equal to it but for
/// rounding.
class BatchEstimator {
 public:
  explicit BatchEstimator(const Weights& weights, InstructionSet set = best_instruction_set());
  ~BatchEstimator();
  BatchEstimator(BatchEstimator&&) noexcept;

  /// 1..32 windows, as many outputs. `batch.label` is not looked at.
  void estimate(const Batch& batch, std::span<Output> outputs);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::network

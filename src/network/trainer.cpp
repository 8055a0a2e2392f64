// SPDX-License-Identifier: MIT
#include "thermorig/network/trainer.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "batch_gradients.h"
#include "denormals.h"

namespace thermorig::network {

struct Trainer::Parts {
  using Phase = void (Parts::*)(Share);

  Parts(const Weights& weights, const TrainerConfig& settings, Workers& pool)
      : config(settings), workers(pool), network(weights, settings.set), gradients(network) {}

  /// Lets the workers do a phase and waits for all.
  void run(Phase next) {
    phase = next;
    workers.run(work);
  }

  // The phases that are shared out. Nothing is summed across workers, so their number does not show.
  void load(Share share) { network.load(*batch, share); }
  void convolve1(Share share) { network.convolve1(share); }
  void convolve2(Share share) { network.convolve2(share); }
  void dense1(Share share) { network.dense1(share); }
  void dense1_back(Share share) { gradients.dense1(share); }
  void convolve2_back(Share share) {
    gradients.convolve2_weights(share);
    gradients.convolve2_input(share);
  }
  void convolve1_back(Share share) { gradients.convolve1(share); }

  StepLoss forward_and_backward(const Batch& windows, const AdamSteps* adam);
  AdamStep next_adam_step(double rate_share) const;

  TrainerConfig config;
  Workers& workers;
  BatchNetwork network;
  BatchGradients gradients;
  std::uint64_t steps = 0;

  const Batch* batch = nullptr;
  Phase phase = nullptr;
  // Made once: a function made anew for each phase could allocate.
  const std::function<void(int)> work = [this](int worker) {
    const FlushDenormals flush;
    (this->*phase)({worker, workers.size()});
  };
};

StepLoss Trainer::Parts::forward_and_backward(const Batch& windows, const AdamSteps* adam) {
  assert(!windows.frames.empty() && windows.frames.size() <= max_batch);
  assert(windows.label.size() == windows.frames.size());
  assert(!network.shape().fusion || windows.gyro.size() == windows.frames.size());
  const FlushDenormals flush;
  batch = &windows;
  run(&Parts::load);
  run(&Parts::convolve1);
  run(&Parts::convolve2);
  run(&Parts::dense1);
  network.heads();
  gradients.begin(adam);
  const StepLoss loss = gradients.heads(windows, config.loss);
  run(&Parts::dense1_back);
  run(&Parts::convolve2_back);
  run(&Parts::convolve1_back);
  return loss;
}

constexpr double least_rate = 1e-15;  // moves no weight, but can be divided by

/// Kingma & Ba 2015, section 2: the corrections of both moments' bias in the rate.
AdamStep Trainer::Parts::next_adam_step(double rate_share) const {
  const AdamConfig& adam = config.adam;
  const double step = static_cast<double>(steps + 1);
  const double first = 1.0 - std::pow(static_cast<double>(adam.beta1), step);
  const double second = std::sqrt(1.0 - std::pow(static_cast<double>(adam.beta2), step));
  const double rate = std::max(rate_share * static_cast<double>(adam.rate) * second / first, least_rate);
  return {.root_scale = static_cast<float>(0.25 / (rate * rate)),
          .divisor_least = static_cast<float>(adam.epsilon * second / rate),
          .one_minus_beta1 = 1.0F - adam.beta1,
          .one_minus_beta2 = 1.0F - adam.beta2};
}

Trainer::Trainer(const Weights& weights, const TrainerConfig& config, Workers& workers)
    : parts_(std::make_unique<Parts>(weights, config, workers)) {}

Trainer::~Trainer() = default;
Trainer::Trainer(Trainer&&) noexcept = default;

const Shape& Trainer::shape() const {
  return parts_->network.shape();
}

StepLoss Trainer::step(const Batch& batch, double rate_share) {
  const double wide_share = rate_share * static_cast<double>(parts_->config.adam.wide_rate);
  const AdamSteps adam{parts_->next_adam_step(rate_share), parts_->next_adam_step(wide_share)};
  const StepLoss loss = parts_->forward_and_backward(batch, &adam);
  const FlushDenormals flush;
  parts_->gradients.change_small_tensors();
  ++parts_->steps;
  return loss;
}

std::vector<float> Trainer::gradients(const Batch& batch) {
  parts_->forward_and_backward(batch, nullptr);
  std::vector<float> gradients(weight_count(shape()));
  parts_->network.layout().unpack(parts_->gradients.gradient(), gradients);
  return gradients;
}

Weights Trainer::weights() const {
  Weights weights{.shape = shape(), .values = std::vector<float>(weight_count(shape()))};
  parts_->network.layout().unpack(parts_->network.weights(), weights.values);
  return weights;
}

OptimiserState Trainer::optimiser() const {
  const BatchLayout& layout = parts_->network.layout();
  OptimiserState state{.first = std::vector<float>(weight_count(shape())),
                       .second = std::vector<float>(weight_count(shape())),
                       .steps = parts_->steps};
  layout.unpack(parts_->gradients.first_moment(), state.first);
  layout.unpack(parts_->gradients.second_moment(), state.second);
  return state;
}

void Trainer::restore(const Weights& weights, const OptimiserState& optimiser) {
  assert(weights.shape == shape() && weights.values.size() == weight_count(shape()));
  assert(optimiser.first.size() == weights.values.size() && optimiser.second.size() == weights.values.size());
  const BatchLayout& layout = parts_->network.layout();
  layout.pack(weights.values, parts_->network.weights());
  layout.pack(optimiser.first, parts_->gradients.first_moment());
  layout.pack(optimiser.second, parts_->gradients.second_moment());
  parts_->steps = optimiser.steps;
  parts_->network.pack_convolutions();
}

}  // namespace thermorig::network

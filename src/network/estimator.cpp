// SPDX-License-Identifier: MIT
#include "thermorig/network/estimator.h"

#include "inference_network.h"

namespace thermorig::network {

struct Estimator::Parts {
  InferenceNetwork network;
};

Estimator::Estimator(const Weights& weights, Precision precision, InstructionSet set)
    : parts_(std::make_unique<Parts>(Parts{InferenceNetwork(weights, precision, set)})) {}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Shape& Estimator::shape() const {
  return parts_->network.shape();
}

Output Estimator::estimate(std::span<const float> frames, float gyro) {
  InferenceNetwork& network = parts_->network;
  network.load(frames);
  network.convolve1();
  network.convolve2();
  network.list_features();
  network.dense1();
  return network.heads(gyro);
}

}  // namespace thermorig::network

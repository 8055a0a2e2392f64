// SPDX-License-Identifier: MIT
#include <cassert>

#include "batch_network.h"
#include "denormals.h"
#include "thermorig/network/trainer.h"

namespace thermorig::network {

struct BatchEstimator::Parts {
  BatchNetwork network;
};

BatchEstimator::BatchEstimator(const Weights& weights, InstructionSet set)
    : parts_(std::make_unique<Parts>(Parts{BatchNetwork(weights, set)})) {}

BatchEstimator::~BatchEstimator() = default;
BatchEstimator::BatchEstimator(BatchEstimator&&) noexcept = default;

void BatchEstimator::estimate(const Batch& batch, std::span<Output> outputs) {
  BatchNetwork& network = parts_->network;
  const bool fusion = network.shape().fusion;
  assert(!batch.frames.empty() && batch.frames.size() <= max_batch);
  assert(outputs.size() == batch.frames.size() && (!fusion || batch.gyro.size() == outputs.size()));
  const FlushDenormals flush;
  network.load(batch, {});
  network.convolve1({});
  network.convolve2({});
  network.dense1({});
  network.heads();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const float thermal = network.thermal.data()[i];
    const float gain = fusion ? network.gain.data()[i] : 1.0F;
    const float gyro = fusion ? batch.gyro[i] : 0.0F;
    outputs[i] = {fusion ? gain * thermal + (1.0F - gain) * gyro : thermal, thermal, gain};  // paper eq. 2
  }
}

}  // namespace thermorig::network

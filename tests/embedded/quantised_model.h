// SPDX-License-Identifier: MIT
#pragma once

#include "network/embedded/quantisation.h"
#include "thermorig/network/model/model.h"

namespace thermorig::tests {

/// The model whose weights are what the int8 source computes with: for judging what that costs.
inline model::Model quantised(const model::Model& model) {
  model::Model result = model;
  for (const network::Tensor& tensor : network::tensors_of(model.weights.shape)) {
    if (!embedded::fits_8_bits(tensor)) continue;
    const std::span<float> weights = result.weights.tensor(tensor.name);
    const auto rows = static_cast<std::size_t>(tensor.dimensions.front());
    const embedded::Quantised small = embedded::quantise(weights, rows);
    for (std::size_t i = 0; i < weights.size(); ++i)
      weights[i] = static_cast<float>(small.values[i]) * small.scales[i / (weights.size() / rows)];
  }
  return result;
}

}  // namespace thermorig::tests

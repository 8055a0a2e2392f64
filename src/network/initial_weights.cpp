// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include "thermorig/network/weights.h"

namespace thermorig::network {

namespace {

/// Values that one output of the tensor's layer sums over.
int fan_in(const Tensor& weight) {
  int product = 1;
  for (std::size_t d = 1; d < weight.dimensions.size(); ++d) product *= weight.dimensions[d];
  return product;
}

/// Uniform in [-1, 1), from the upper 24 bits: exact in a float, so equal everywhere.
float draw(std::mt19937_64& random) {
  const auto upper = static_cast<int>(random() >> 40U);
  return static_cast<float>(upper - (1 << 23)) / static_cast<float>(1 << 23);
}

}  // namespace

Weights initial_weights(const Shape& shape, std::uint64_t seed) {
  Weights weights{shape, std::vector<float>(weight_count(shape))};
  std::mt19937_64 random(seed);  // its raw numbers are the standard's, distributions are each library's own
  float bound = 0.0F;
  for (const Tensor& tensor : tensors_of(shape)) {
    // A bias follows its layer's weights and has their bound.
    if (tensor.dimensions.size() > 1)
      bound = static_cast<float>(1.0 / std::sqrt(static_cast<double>(fan_in(tensor))));
    for (std::size_t i = 0; i < tensor.size; ++i) weights.values[tensor.offset + i] = bound * draw(random);
  }
  return weights;
}

}  // namespace thermorig::network

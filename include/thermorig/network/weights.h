// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "thermorig/network/shape.h"

namespace thermorig::network {

/// One tensor among the weights: its documented name, its dimensions as PyTorch has them, its place.
struct Tensor {
  std::string_view name;        // e.g. "conv1.weight"
  std::vector<int> dimensions;  // e.g. {6, Nf, 5, 5}
  std::size_t offset = 0;       // of its first value in Weights::values
  std::size_t size = 0;
};

/// The tensors of a shape in their order: conv1.weight (6, Nf, 5, 5), conv1.bias (6), conv2.weight (16, 6, 5,
/// 5), conv2.bias (16), speed1.weight (120, features), speed1.bias (120), speed2.weight (80, 120),
/// speed2.bias (80), speed3.weight (1, 80), speed3.bias (1), and with fusion gain1.weight (120, features),
/// gain1.bias (120), gain2.weight (1, 120), gain2.bias (1). Convolutions are cross-correlations, as in
/// PyTorch.
std::vector<Tensor> tensors_of(const Shape& shape);

/// All weights of a network in the order of `tensors_of`, each tensor row-major.
struct Weights {
  Shape shape;
  std::vector<float> values;  // weight_count(shape)

  std::span<float> tensor(std::string_view name);
  std::span<const float> tensor(std::string_view name) const;
  bool operator==(const Weights&) const = default;
};

/// Uniform in +-1/sqrt(fan-in), weights and biases, as PyTorch's default. The same seed gives the same bits
/// everywhere.
Weights initial_weights(const Shape& shape, std::uint64_t seed);

}  // namespace thermorig::network

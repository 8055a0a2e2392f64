// SPDX-License-Identifier: MIT
#include "quantisation.h"

#include <algorithm>
#include <cmath>

namespace thermorig::embedded {

namespace {

constexpr float largest = 127.0F;

float scale_of(std::span<const float> row) {
  float most = 0.0F;
  for (float weight : row) most = std::max(most, std::abs(weight));
  return most / largest;
}

std::int8_t nearest(float weight, float scale) {
  if (scale == 0.0F) return 0;
  return static_cast<std::int8_t>(std::clamp(std::nearbyint(weight / scale), -largest, largest));
}

}  // namespace

Quantised quantise(std::span<const float> weights, std::size_t rows) {
  Quantised quantised;
  const std::size_t row_size = weights.size() / rows;
  for (std::size_t begin = 0; begin < weights.size(); begin += row_size) {
    const auto row = weights.subspan(begin, row_size);
    const float scale = scale_of(row);
    quantised.scales.push_back(scale);
    for (float weight : row) quantised.values.push_back(nearest(weight, scale));
  }
  return quantised;
}

bool is_bias(const network::Tensor& tensor) {
  return tensor.name.ends_with(".bias");
}

bool fits_8_bits(const network::Tensor& tensor) {
  return tensor.name == "conv1.weight" || tensor.name == "conv2.weight" || tensor.name == "speed1.weight" ||
         tensor.name == "gain1.weight";
}

}  // namespace thermorig::embedded

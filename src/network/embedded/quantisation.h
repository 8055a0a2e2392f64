// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/network/weights.h"

namespace thermorig::embedded {

/// A tensor of weights in 8 bits, symmetric: weight = value * scale of its row, values -127..127. A row is
/// what one output is made of: a filter, or a row of a matrix.
struct Quantised {
  std::vector<std::int8_t> values;
  std::vector<float> scales;  // one a row; 0: a row of zeros
};

/// `weights` finite, of `rows` equal rows.
Quantised quantise(std::span<const float> weights, std::size_t rows);

bool is_bias(const network::Tensor& tensor);

/// The convolutions and the heads' first layers: nearly all weights. The rest stay float32: they are few, and
/// what they are off reaches the outputs hardly averaged (measured: docs/export.md).
bool fits_8_bits(const network::Tensor& tensor);

}  // namespace thermorig::embedded

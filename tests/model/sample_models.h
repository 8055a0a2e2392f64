// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/network/model/model.h"

namespace thermorig::model {

/// A model with seeded weights and every field of its provenance set.
Model sample_model(const network::Shape& shape, std::uint64_t seed = 1);

/// Thermal-only, Nr = 3: the smallest there is, about 200 kB.
Model small_model();

/// Every Nf and Nr, fusion and thermal-only.
std::vector<network::Shape> all_shapes();

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline Model reread(const std::string& file) {
  return from_onnx(bytes_of(file), "sample.onnx");
}

/// What `from_onnx` says of the bytes: "" if it takes them, "what | advice" if it refuses them with exit code
/// 8. Anything else fails the test.
std::string refusal_of(const std::string& file);

}  // namespace thermorig::model

// SPDX-License-Identifier: MIT
#pragma once

// Weights and batches by a formula that seeded_values.py computes to the same bits.

#include <cmath>
#include <cstdint>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/weights.h"

namespace thermorig::interop {

/// `count` numbers in -1 <= x < 1, each exactly a float: the upper bits of SplitMix64 (Steele et al. 2014).
inline std::vector<float> seeded_values(std::uint64_t seed, std::size_t count) {
  std::vector<float> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t state = ((seed << 32) + i + 1) * 0x9E3779B97F4A7C15U;
    state = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9U;
    state = (state ^ (state >> 27)) * 0x94D049BB133111EBU;
    state = state ^ (state >> 31);
    values[i] = static_cast<float>(static_cast<double>(state >> 40) / 8388608.0 - 1.0);
  }
  return values;
}

/// Uniform in +-1/sqrt(fan-in), tensor by tensor.
inline network::Weights seeded_weights(const network::Shape& shape, std::uint64_t seed) {
  network::Weights weights{shape, {}};
  double fan_in = 1.0;
  std::uint64_t index = 0;
  for (const network::Tensor& tensor : network::tensors_of(shape)) {
    if (tensor.dimensions.size() > 1)
      fan_in = static_cast<double>(tensor.size) / static_cast<double>(tensor.dimensions[0]);
    for (float value : seeded_values(seed + index, tensor.size))
      weights.values.push_back(static_cast<float>(static_cast<double>(value) / std::sqrt(fan_in)));
    ++index;
  }
  return weights;
}

/// Batch `number` of a seed; batches repeat after four. Owns what `batch()` points to.
class SeededBatch {
 public:
  SeededBatch(const network::Shape& shape, std::uint64_t seed, std::uint64_t number, std::size_t samples) {
    const std::uint64_t first = seed + 3 * (number % 4);
    pixels_ = seeded_values(first, samples * shape.inputs());
    for (float& pixel : pixels_) pixel *= 1.7320508F;  // a deviation of 1
    label_ = seeded_values(first + 1, samples);
    gyro_ = seeded_values(first + 2, samples);
    for (std::size_t i = 0; i < samples; ++i) gyro_[i] = label_[i] + 0.25F * gyro_[i];
    for (std::size_t i = 0; i < samples; ++i) frames_.push_back(pixels_.data() + i * shape.inputs());
    if (!shape.fusion) gyro_.clear();
  }
  SeededBatch(const SeededBatch&) = delete;
  SeededBatch& operator=(const SeededBatch&) = delete;

  /// Flips every second window and negates its speeds.
  void mirror_every_second() {
    mirrored_.assign(label_.size(), 0);
    for (std::size_t i = 1; i < label_.size(); i += 2) {
      mirrored_[i] = 1;
      label_[i] = -label_[i];
      if (!gyro_.empty()) gyro_[i] = -gyro_[i];
    }
  }

  network::Batch batch() const { return {frames_, gyro_, label_, mirrored_}; }

 private:
  std::vector<float> pixels_, gyro_, label_;
  std::vector<const float*> frames_;
  std::vector<std::uint8_t> mirrored_;
};

}  // namespace thermorig::interop

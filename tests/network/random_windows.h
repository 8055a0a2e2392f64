// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/shape.h"

namespace thermorig::network {

/// Uniform in [-1, 1), the same everywhere for a seed.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double operator()() { return static_cast<double>(random_() >> 11U) / 4503599627370496.0 - 1.0; }

 private:
  std::mt19937_64 random_;
};

/// Random windows for a shape: pixels in +-2, labels and gyro in +-1, every other one mirrored.
struct RandomWindows {
  std::vector<std::vector<float>> frames;
  std::vector<float> gyro, label;
  std::vector<std::uint8_t> mirrored;

  RandomWindows(const Shape& shape, int count, std::uint64_t seed)
      : frames(static_cast<std::size_t>(count), std::vector<float>(shape.inputs())) {
    Draw draw(seed);
    for (auto& window : frames) {
      for (float& v : window) v = static_cast<float>(2.0 * draw());
      gyro.push_back(static_cast<float>(draw()));
      label.push_back(static_cast<float>(draw()));
      mirrored.push_back(static_cast<std::uint8_t>(mirrored.size() % 2));
    }
  }

  /// Valid until the next call or the end of this.
  Batch batch() {
    pointers_.clear();
    for (const auto& window : frames) pointers_.push_back(window.data());
    return {pointers_, gyro, label, mirrored};
  }

 private:
  std::vector<const float*> pointers_;
};

}  // namespace thermorig::network

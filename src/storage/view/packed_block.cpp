// SPDX-License-Identifier: MIT
#include "packed_block.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "thermorig/core/frame.h"

namespace thermorig::view {

namespace {

constexpr int greatest_code = no_code - 1;
constexpr std::int16_t no_temperature = std::numeric_limits<std::int16_t>::min();

std::int16_t hundredths_at(std::string_view images, std::size_t pixel) {
  std::int16_t value = 0;
  std::memcpy(&value, images.data() + pixel * sizeof value, sizeof value);
  return value;
}

/// Codes of a block's pixels.
struct Scale {
  int least = 0;  // hundredths
  int range = 0;

  explicit Scale(std::string_view images) {
    int low = std::numeric_limits<std::int16_t>::max(), high = no_temperature;
    for (std::size_t pixel = 0; pixel < images.size() / 2; ++pixel) {
      const int value = hundredths_at(images, pixel);
      if (value == no_temperature) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (low > high) return;
    least = low;
    range = std::max(high - low, greatest_code);
  }

  float step_c() const { return static_cast<float>(0.01 * std::max(range, greatest_code) / greatest_code); }

  unsigned char code_of(std::int16_t value) const {
    if (value == no_temperature) return no_code;
    return static_cast<unsigned char>(((value - least) * greatest_code + range / 2) / range);
  }
};

void append_float(std::string& block, float value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  block.append(bytes, sizeof value);
}

}  // namespace

std::string packed_block(std::string_view images) {
  const Scale scale(images);
  const std::size_t pixels = images.size() / 2;
  std::string block;
  block.reserve(2 * sizeof(float) + pixels);
  append_float(block, static_cast<float>(0.01 * scale.least));
  append_float(block, scale.step_c());
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const unsigned before =
        pixel < frame_pixels ? 0 : scale.code_of(hundredths_at(images, pixel - frame_pixels));
    block += static_cast<char>(scale.code_of(hundredths_at(images, pixel)) - before);
  }
  return block;
}

}  // namespace thermorig::view

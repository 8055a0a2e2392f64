// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/checksums.h"

#include <cstddef>

namespace thermorig::wire {

std::uint8_t byte_sum8(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint8_t>(byte_sum16(bytes) & 0xFFU);
}

std::uint16_t byte_sum16(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint16_t>(sum);
}

std::uint16_t word_sum16(std::span<const std::uint8_t> bytes) {
  std::uint32_t low = 0;
  std::uint32_t high = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    low += bytes[i];
    high += bytes[i + 1];
  }
  return static_cast<std::uint16_t>(low + (high << 8));
}

}  // namespace thermorig::wire

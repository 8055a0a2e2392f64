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

std::uint16_t crc16_xmodem(std::span<const std::uint8_t> bytes, std::uint16_t crc) {
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ (byte << 8));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000U) != 0 ? (crc << 1) ^ 0x1021U : crc << 1);
  }
  return crc;
}

}  // namespace thermorig::wire

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace thermorig::wire {

/// Low byte of the sum of all bytes: WitMotion packets, the camera's commands and replies.
std::uint8_t byte_sum8(std::span<const std::uint8_t> bytes);

/// Sum of all bytes mod 65536: the check of some clones of the camera bridge.
std::uint16_t byte_sum16(std::span<const std::uint8_t> bytes);

/// Sum mod 65536 of the little-endian 16-bit words; `bytes` holds whole words. The camera's frame check.
std::uint16_t word_sum16(std::span<const std::uint8_t> bytes);

/// CRC-16/XMODEM: polynomial 1021, start 0, not reflected ("123456789" gives 31C3). `crc`: of what stood
/// before.
std::uint16_t crc16_xmodem(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0);

}  // namespace thermorig::wire

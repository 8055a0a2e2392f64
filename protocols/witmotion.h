// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// Bytes of WitMotion sensors ("WIT Standard Communication Protocol"). Description: witmotion.md.
namespace witmotion {

inline constexpr std::uint8_t sync = 0x55;

// A packet: sync, type, four i16 (little-endian), low byte of the sum of the ten bytes before.
inline constexpr std::size_t packet_bytes = 11;
inline constexpr std::size_t words = 4;
inline constexpr std::size_t words_offset = 2;
inline constexpr std::size_t sum_offset = 10;

inline constexpr std::uint8_t type_first = 0x50;  // time
inline constexpr std::uint8_t type_acceleration = 0x51;
inline constexpr std::uint8_t type_gyro = 0x52;  // x, y, z, temperature
inline constexpr std::uint8_t type_angle = 0x53;
inline constexpr std::uint8_t type_last = 0x5A;      // GPS accuracy
inline constexpr std::uint8_t type_register = 0x5F;  // answer to "read register"

// "Read register", to the device: answered by four registers from the one that is named, its number not among
// them.
inline constexpr std::array<std::uint8_t, 3> read_register{0xFF, 0xAA, 0x27};  // then its number, and 0
inline constexpr std::uint8_t register_bandwidth = 0x1F;
// Of its low-pass, by the value of that register.
inline constexpr std::array<double, 7> bandwidths_hz{256.0, 188.0, 98.0, 42.0, 20.0, 10.0, 5.0};

inline constexpr double full_scale_dps = 2000.0;  // at 32768 counts, on every model, fixed
inline constexpr double counts_full_scale = 32768.0;
inline constexpr double temperature_counts_per_kelvin = 100.0;

}  // namespace witmotion

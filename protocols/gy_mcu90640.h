// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

/// Bytes of the GY-MCU90640 bridge ("GYMCU90640 Module User Manual V1.0"). Description: gy_mcu90640.md.
namespace gy_mcu90640 {

inline constexpr std::uint8_t sync = 0x5A;  // sent twice before every frame and every reply

// A frame: sync, sync, length (u16), pixels (768 x i16), Ta (i16), checksum (u16); little-endian.
inline constexpr std::size_t pixels = 768;
inline constexpr std::size_t length_offset = 2;
inline constexpr std::size_t pixels_offset = 4;
inline constexpr std::size_t sensor_temp_offset = pixels_offset + 2 * pixels;
inline constexpr std::size_t checksum_offset = sensor_temp_offset + 2;
inline constexpr std::size_t frame_bytes = checksum_offset + 2;
inline constexpr std::uint16_t frame_length = 2 * pixels + 2;  // what the length field says: pixels and Ta
inline constexpr std::size_t header_bytes = 4;
inline constexpr double counts_per_kelvin = 100.0;  // centidegrees Celsius, signed
static_assert(frame_bytes == 1544 && frame_length == 0x0602);

// A reply to "read emissivity": sync, sync, emissivity in hundredths, sum of the three bytes.
inline constexpr std::size_t reply_bytes = 4;
inline constexpr std::uint8_t emissivity_max = 100;

// A command: command_sync, command, value, sum of the three bytes.
inline constexpr std::uint8_t command_sync = 0xA5;
inline constexpr std::uint8_t command_rate = 0x25;             // values 0..4: 0.5, 1, 2, 4, 8 Hz
inline constexpr std::uint8_t command_output = 0x35;           // value 1: one frame now; 2: automatic
inline constexpr std::uint8_t command_read_emissivity = 0x55;  // value 1; answered with a reply
inline constexpr std::uint8_t output_query = 0x01;
inline constexpr std::uint8_t output_automatic = 0x02;

}  // namespace gy_mcu90640

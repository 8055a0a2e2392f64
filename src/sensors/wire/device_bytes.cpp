// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/device_bytes.h"

#include <algorithm>
#include <cmath>

#include "thermorig/sensors/wire/checksums.h"

namespace thermorig::wire {

namespace {

void put_u16(std::uint8_t* at, std::uint16_t value) {
  at[0] = static_cast<std::uint8_t>(value & 0xFFU);
  at[1] = static_cast<std::uint8_t>(value >> 8);
}

void put_i16(std::uint8_t* at, std::int16_t value) {
  put_u16(at, static_cast<std::uint16_t>(value));
}

std::int16_t centi(float value) {
  const double rounded = std::nearbyint(static_cast<double>(value) * 100.0);
  return static_cast<std::int16_t>(std::max(-32768.0, std::min(32767.0, rounded)));
}

}  // namespace

std::vector<std::uint8_t> camera_frame(const ThermalFrame& frame) {
  std::vector<std::uint8_t> bytes(gy_mcu90640::frame_bytes);
  bytes[0] = bytes[1] = gy_mcu90640::sync;
  put_u16(&bytes[gy_mcu90640::length_offset], gy_mcu90640::frame_length);
  for (std::size_t i = 0; i < frame_pixels; ++i)
    put_i16(&bytes[gy_mcu90640::pixels_offset + 2 * i], centi(frame.temp_c[i]));
  put_i16(&bytes[gy_mcu90640::sensor_temp_offset], centi(frame.sensor_temp_c));
  put_u16(&bytes[gy_mcu90640::checksum_offset],
          word_sum16(std::span(bytes).first(gy_mcu90640::checksum_offset)));
  return bytes;
}

std::array<std::uint8_t, witmotion_packet_bytes> witmotion_packet(std::uint8_t type,
                                                                  const std::array<std::int16_t, 4>& words) {
  std::array<std::uint8_t, witmotion_packet_bytes> bytes{witmotion::sync, type};
  for (std::size_t i = 0; i < words.size(); ++i) put_i16(&bytes[witmotion::words_offset + 2 * i], words[i]);
  bytes[witmotion::sum_offset] = byte_sum8(std::span(bytes).first(witmotion::sum_offset));
  return bytes;
}

std::array<std::uint8_t, witmotion_packet_bytes> witmotion_gyro_packet(
    const std::array<std::int16_t, 3>& counts, float temp_c) {
  return witmotion_packet(witmotion::type_gyro, {counts[0], counts[1], counts[2], centi(temp_c)});
}

}  // namespace thermorig::wire

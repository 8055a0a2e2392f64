// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <array>
#include <bit>
#include <string>

#include "camera.h"
#include "encoder_table.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

std::vector<std::uint8_t> gy_mcu90640_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  return wire::camera_frame(frame.frame);
}

/// As Adafruit's example prints it, with its temperatures on: a line of marks, the sensor's own temperature,
/// 24 lines of 32 with a comma behind each.
std::vector<std::uint8_t> text_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  std::string text =
      fmt::format("{:=<35}\r\nAmbient temperature = {:.2f} degC\r\n\r\n\r\n", "", frame.frame.sensor_temp_c);
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    text += fmt::format("{:.1f}, {}", frame.frame.temp_c[pixel],
                        pixel % frame_columns == frame_columns - 1 ? "\r\n" : "");
  return {text.begin(), text.end()};
}

/// A mark and 768 floats, as the memory of a little-endian board holds them.
std::vector<std::uint8_t> binary_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  std::vector<std::uint8_t> bytes{0xAA, 0xBB, 0xCC, 0xDD};
  for (const float temp_c : frame.frame.temp_c) {
    const auto word = std::bit_cast<std::uint32_t>(temp_c);
    for (unsigned shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  return bytes;
}

/// Rate, one frame, automatic output: the manual's table. What else it may be told is not heard.
Heard gy_mcu90640_hear(std::span<const std::uint8_t> bytes, const CameraProfile&) {
  constexpr std::array rates_hz{0.5, 1.0, 2.0, 4.0, 8.0};
  Heard heard;
  for (std::size_t i = 0; i + 4 <= bytes.size(); ++i) {
    if (bytes[i] != 0xA5 || bytes[i + 3] != static_cast<std::uint8_t>(0xA5 + bytes[i + 1] + bytes[i + 2]))
      continue;
    const unsigned value = bytes[i + 2];
    if (bytes[i + 1] == 0x25 && value < rates_hz.size()) heard.rate_hz = rates_hz[value];
    if (bytes[i + 1] == 0x35) heard.asks_for_one = value == 1;
    if (bytes[i + 1] == 0x35) heard.asks_for_stream = value == 2;
  }
  return heard;
}

constexpr std::array all_camera_encoders{CameraEncoder{"gy-mcu90640", gy_mcu90640_bytes, gy_mcu90640_hear},
                                         CameraEncoder{"text", text_bytes, nullptr},
                                         CameraEncoder{"binary", binary_bytes, nullptr}};

}  // namespace

std::span<const CameraEncoder> camera_encoders() {
  return all_camera_encoders;
}

const CameraEncoder& camera_encoder(const CameraProfile& profile) {
  return encoder_named(camera_encoders(), profile.protocol, "camera");
}

}  // namespace thermorig::simulation

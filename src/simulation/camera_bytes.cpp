// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <mlx_raw.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <string>

#include "camera.h"
#include "encoder_table.h"
#include "raw_mlx90640.h"
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
    if (bytes[i + 1] == 0x35) heard.asked = value == 1 ? 1 : 0;
    if (bytes[i + 1] == 0x35) heard.asks_for_stream = value == 2;
  }
  return heard;
}

/// Words of four digits, a comma between two.
template <std::size_t Size>
void put_words(std::string& text, const std::array<std::uint16_t, Size>& words) {
  for (std::size_t i = 0; i < Size; ++i) text += fmt::format("{}{:04X}", i == 0 ? "" : ",", words[i]);
}

const RawMlx90640& raw_sensor() {
  static const RawMlx90640 sensor(1);
  return sensor;
}

RawMlx90640::HalfFrame words_of(const SimulatedFrame& frame) {
  RawMlx90640::State state;
  state.sensor_temp_c = static_cast<double>(frame.frame.sensor_temp_c);
  return raw_sensor().half_frame(frame.frame.temp_c, frame.newest_half, state);
}

std::vector<std::uint8_t> i2c_stick_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  std::string text = fmt::format("raw:33:{:08}:", frame.ready_ns / 1'000'000);
  put_words(text, words_of(frame));
  text += "\r\n";
  return {text.begin(), text.end()};
}

/// Line by line, as its firmware takes them; what it answers to settings is left out but for the EEPROM.
Heard i2c_stick_hear(std::span<const std::uint8_t> bytes, const CameraProfile&) {
  Heard heard;
  std::string answer;
  std::string line;
  for (const std::uint8_t byte : bytes) {
    const char c = static_cast<char>(byte);
    if (line.empty() && c == '!') answer += "!:interactive mode\r\n";
    if (c != '\n' && c != '\r' && c != '!') line += c;
    if (c != '\n') continue;
    if (line == "raw:33") ++heard.asked;
    if (line.starts_with("+cs:33:RR=")) {
      heard.rate_hz = std::ldexp(0.5, std::atoi(line.c_str() + 10));
      answer += "+cs:33:RR=OK [mlx-register]\r\n";
    }
    if (line == "mr:33:2400,0340") {
      answer += "mr:33:2400,10,01,0340,DATA,";
      put_words(answer, raw_sensor().eeprom());
      answer += "\r\n";
    }
    line.clear();
  }
  heard.answer.assign(answer.begin(), answer.end());
  return heard;
}

void put_raw_message(std::vector<std::uint8_t>& bytes, std::uint8_t kind,
                     std::span<const std::uint16_t> words) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + mlx_raw_size(static_cast<std::uint16_t>(words.size())));
  std::uint8_t* const message = bytes.data() + begin;
  mlx_raw_header(message, kind, static_cast<std::uint16_t>(words.size()));
  std::uint8_t* at = message + MLX_RAW_HEADER_BYTES;
  const auto put = [&at](std::uint16_t word) {
    *at++ = static_cast<std::uint8_t>(word >> 8U);
    *at++ = static_cast<std::uint8_t>(word & 0xFFU);
  };
  for (const std::uint16_t word : words) put(word);
  put(mlx_raw_sum(0, message, static_cast<std::size_t>(at - message)));
}

/// On a bus of the computer: that there is new data, and then the data.
std::vector<std::uint8_t> mlx_raw_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  std::vector<std::uint8_t> bytes;
  const std::array<std::uint16_t, 1> new_data{static_cast<std::uint16_t>(8U | frame.newest_half)};
  put_raw_message(bytes, MLX_RAW_NEW_DATA, new_data);
  put_raw_message(bytes, MLX_RAW_HALF, words_of(frame));
  return bytes;
}

Heard mlx_raw_hear(std::span<const std::uint8_t> bytes, const CameraProfile&) {
  Heard heard;
  const std::string text(bytes.begin(), bytes.end());
  const auto at = text.find(MLX_RAW_COMMAND);
  if (at == std::string::npos || at + 5 > text.size() || text[at + 4] != '\n') return heard;
  const char rate = text[at + 3];
  heard.asks_for_stream = true;
  if (rate >= '0' && rate <= '7') heard.rate_hz = std::ldexp(0.5, rate - '0');
  put_raw_message(heard.answer, MLX_RAW_EEPROM, raw_sensor().eeprom());
  return heard;
}

constexpr std::array all_camera_encoders{CameraEncoder{"gy-mcu90640", gy_mcu90640_bytes, gy_mcu90640_hear},
                                         CameraEncoder{"text", text_bytes, nullptr},
                                         CameraEncoder{"binary", binary_bytes, nullptr},
                                         CameraEncoder{"i2c-stick", i2c_stick_bytes, i2c_stick_hear},
                                         CameraEncoder{"mlx-raw", mlx_raw_bytes, mlx_raw_hear}};

}  // namespace

std::span<const CameraEncoder> camera_encoders() {
  return all_camera_encoders;
}

const CameraEncoder& camera_encoder(const CameraProfile& profile) {
  return encoder_named(camera_encoders(), profile.protocol, "camera");
}

}  // namespace thermorig::simulation

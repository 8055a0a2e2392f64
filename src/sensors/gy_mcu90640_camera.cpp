// SPDX-License-Identifier: MIT
// The GY-MCU90640 bridge. Source: protocols/gy_mcu90640.md.
#include "gy_mcu90640.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::sensors {

namespace {

constexpr std::array<UsualBaud, 3> camera_bauds{{{460800, 0.12}, {115200, 0.15}, {9600, 0.11}}};

CameraScanner gy_mcu90640_scanner(const CameraProfile& profile) {
  return CameraScanner(wire::CameraScanner(profile.checksum));
}

std::optional<Evidence> recognise_gy_mcu90640(std::span<const std::uint8_t> bytes) {
  wire::CameraScanner scanner;
  std::vector<wire::CameraMessage> messages;
  scanner.push(bytes, messages);
  if (messages.empty()) return std::nullopt;
  return Evidence{.messages = messages.size(),
                  .bytes = scanner.counters().bytes_in_messages,
                  .text = fmt::format("{} camera frame(s), checksums good", messages.size()),
                  .text_format = {}};
}

struct RateCode {
  double rate_hz;
  std::uint8_t value;
};
constexpr std::array<RateCode, 5> rate_codes{{{0.5, 0}, {1.0, 1}, {2.0, 2}, {4.0, 3}, {8.0, 4}}};
constexpr double same_rate = 0.1;  // a measured rate is off by the sensor's clock, a code's neighbour by 2

std::vector<std::uint8_t> command(std::uint8_t code, std::uint8_t value) {
  return {gy_mcu90640::command_sync, code, value,
          static_cast<std::uint8_t>(gy_mcu90640::command_sync + code + value)};
}

std::vector<std::uint8_t> ask_for_frames() {
  return command(gy_mcu90640::command_output, gy_mcu90640::output_automatic);
}

/// Nothing is saved to its flash: after a power cycle it is as its owner has set it.
Commands gy_mcu90640_request(const CameraProfile& profile) {
  Commands commands;
  for (const RateCode& code : rate_codes)
    if (std::abs(profile.output_rate_hz / code.rate_hz - 1.0) <= same_rate)
      commands.push_back(command(gy_mcu90640::command_rate, code.value));
  commands.push_back(ask_for_frames());
  return commands;
}

}  // namespace

CameraProtocol gy_mcu90640_camera() {
  return {.name = "gy-mcu90640",
          .sends = "frames of a GY-MCU90640 board",
          .bauds = camera_bauds,
          .clock = {},
          .message_bytes = gy_mcu90640::frame_bytes,
          .scanner = gy_mcu90640_scanner,
          .recognise = recognise_gy_mcu90640,
          .request = gy_mcu90640_request,
          .greeting = ask_for_frames};
}

}  // namespace thermorig::sensors

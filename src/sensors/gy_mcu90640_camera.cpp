// SPDX-License-Identifier: MIT
// The GY-MCU90640 bridge. Source: protocols/gy_mcu90640.md.
#include "gy_mcu90640.h"

#include <fmt/format.h>

#include <array>

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

}  // namespace

CameraProtocol gy_mcu90640_camera() {
  return {.name = "gy-mcu90640",
          .sends = "frames of a GY-MCU90640 board",
          .bauds = camera_bauds,
          .clock = {},
          .message_bytes = gy_mcu90640::frame_bytes,
          .scanner = gy_mcu90640_scanner,
          .recognise = recognise_gy_mcu90640};
}

}  // namespace thermorig::sensors

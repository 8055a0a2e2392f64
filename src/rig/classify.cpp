// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <vector>

#include "thermorig/rig/detect.h"
#include "thermorig/wire/camera_scanner.h"
#include "thermorig/wire/gyro_scanner.h"
#include "thermorig/wire/servo_messages.h"
#include "thermorig/wire/text_format.h"

namespace thermorig::rig {

namespace {

constexpr double share_needed = 0.3;  // a short look begins and ends in the middle of a message

double share(std::uint64_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// What one device's scanner finds in the bytes; `needed` messages make it that device.
template <typename Message, typename Scanner>
Evidence found_by(Scanner scanner, std::span<const std::uint8_t> bytes, Device device, std::size_t needed,
                  const char* what, std::vector<Message>& messages) {
  scanner.push(bytes, messages);
  Evidence evidence{.messages = messages.size()};
  if (messages.size() >= needed) evidence.role = device;
  evidence.explained_share = share(scanner.counters().bytes_in_messages, bytes.size());
  evidence.text = fmt::format("{} {}", messages.size(), what);
  return evidence;
}

Evidence as_camera(std::span<const std::uint8_t> bytes) {
  std::vector<wire::CameraMessage> messages;
  return found_by(wire::CameraScanner(), bytes, Device::camera, 1, "camera frame(s), checksums good",
                  messages);
}

Evidence as_witmotion(std::span<const std::uint8_t> bytes) {
  std::vector<wire::GyroMessage> messages;
  return found_by(wire::WitmotionScanner(), bytes, Device::gyro, 2, "WitMotion gyro packets", messages);
}

Evidence as_servo(std::span<const std::uint8_t> bytes) {
  std::vector<wire::ServoMessage> messages;
  Evidence evidence =
      found_by(wire::ServoScanner(), bytes, Device::servo, 2, "messages of the servo link", messages);
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text = fmt::format("firmware {} answered hello", welcome->firmware);
  return evidence;
}

Evidence as_text_gyro(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence evidence{.gyro_protocol = GyroProtocol::text};
  evidence.text_format = wire::guess_text_format(bytes, wire::StreamStart::anywhere, heard_s);
  if (!evidence.text_format) return evidence;
  evidence.role = Device::gyro;
  evidence.messages = evidence.text_format->lines;
  evidence.explained_share = share(evidence.text_format->bytes, bytes.size());
  evidence.text = fmt::format("{} lines of numbers, as a text gyro prints them", evidence.messages);
  return evidence;
}

}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence best{.text = bytes.empty() ? "silent"
                                      : fmt::format("{} bytes that no known device sends", bytes.size())};
  for (const Evidence& evidence :
       {as_camera(bytes), as_witmotion(bytes), as_servo(bytes), as_text_gyro(bytes, heard_s)}) {
    const bool convincing = evidence.role && evidence.explained_share >= share_needed;
    if (convincing && evidence.explained_share > best.explained_share) best = evidence;
  }
  return best;
}

}  // namespace thermorig::rig

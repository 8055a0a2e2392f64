// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <vector>

#include "thermorig/rig/detect.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/wire/camera_scanner.h"
#include "thermorig/wire/servo_messages.h"

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

Evidence as_servo(std::span<const std::uint8_t> bytes) {
  std::vector<wire::ServoMessage> messages;
  Evidence evidence =
      found_by(wire::ServoScanner(), bytes, Device::servo, 2, "messages of the servo link", messages);
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text = fmt::format("firmware {} answered hello", welcome->firmware);
  return evidence;
}

Evidence as_gyro(const sensors::GyroProtocol& protocol, std::span<const std::uint8_t> bytes, double heard_s) {
  const auto found = protocol.recognise(bytes, heard_s);
  if (!found) return {};
  return {.role = Device::gyro,
          .gyro_protocol = std::string(protocol.name),
          .messages = found->messages,
          .explained_share = share(found->bytes, bytes.size()),
          .text = found->text,
          .text_format = found->text_format};
}

}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence best{.text = bytes.empty() ? "silent"
                                      : fmt::format("{} bytes that no known device sends", bytes.size())};
  std::vector<Evidence> candidates{as_camera(bytes), as_servo(bytes)};
  for (const sensors::GyroProtocol& protocol : sensors::gyro_protocols())
    candidates.push_back(as_gyro(protocol, bytes, heard_s));
  for (const Evidence& evidence : candidates) {
    const bool convincing = evidence.role && evidence.explained_share >= share_needed;
    if (convincing && evidence.explained_share > best.explained_share) best = evidence;
  }
  return best;
}

}  // namespace thermorig::rig

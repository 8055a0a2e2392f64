// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "thermorig/rig/detect.h"
#include "thermorig/wire/camera_scanner.h"
#include "thermorig/wire/gyro_scanner.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::rig {

namespace {

constexpr double share_needed = 0.3;  // a short look begins and ends in the middle of a message
constexpr std::size_t numbers_needed = 3;

double share(std::uint64_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

Evidence as_camera(std::span<const std::uint8_t> bytes) {
  wire::CameraScanner scanner;
  std::vector<wire::CameraMessage> messages;
  scanner.push(bytes, messages);
  Evidence evidence{.role = Device::camera, .messages = messages.size()};
  evidence.explained_share = share(scanner.counters().bytes_in_messages, bytes.size());
  evidence.text = fmt::format("{} camera frame(s), checksums good", messages.size());
  if (messages.empty()) evidence.role.reset();
  return evidence;
}

Evidence as_witmotion(std::span<const std::uint8_t> bytes) {
  wire::WitmotionScanner scanner;
  std::vector<wire::GyroMessage> messages;
  scanner.push(bytes, messages);
  Evidence evidence{
      .role = Device::gyro, .gyro_protocol = GyroProtocol::witmotion, .messages = messages.size()};
  evidence.explained_share = share(scanner.counters().bytes_in_messages, bytes.size());
  evidence.text = fmt::format("{} WitMotion gyro packets", messages.size());
  if (messages.size() < 2) evidence.role.reset();
  return evidence;
}

Evidence as_servo(std::span<const std::uint8_t> bytes) {
  wire::ServoScanner scanner;
  std::vector<wire::ServoMessage> messages;
  scanner.push(bytes, messages);
  Evidence evidence{.role = Device::servo, .messages = messages.size()};
  evidence.explained_share = share(scanner.counters().bytes_in_messages, bytes.size());
  evidence.text = fmt::format("{} messages of the servo link", messages.size());
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text = fmt::format("firmware {} answered hello", welcome->firmware);
  if (messages.size() < 2) evidence.role.reset();
  return evidence;
}

bool is_text(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); });
}

/// Numbers in a line, as they stand between separators.
std::size_t numbers_in(std::string_view line) {
  std::size_t numbers = 0;
  bool in_field = false;
  for (const char c : line) {
    const bool separator = c == ',' || c == ';' || c == '\t' || c == ' ' || c == ':';
    if (!separator && !in_field && (std::isdigit(static_cast<unsigned char>(c)) || c == '-' || c == '.'))
      ++numbers;
    in_field = !separator;
  }
  return numbers;
}

// The first and the last line are left out: they may have begun before, or go on after, these bytes.
Evidence as_text_gyro(std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  Evidence evidence{.role = Device::gyro, .gyro_protocol = GyroProtocol::text};
  std::uint64_t explained = 0;
  std::size_t begin = text.find('\n');
  while (begin != std::string_view::npos) {
    const std::size_t end = text.find('\n', begin + 1);
    if (end == std::string_view::npos) break;
    std::string_view line = text.substr(begin + 1, end - begin - 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (is_text(line) && numbers_in(line) >= numbers_needed) {
      ++evidence.messages;
      explained += end - begin;
    }
    begin = end;
  }
  evidence.explained_share = share(explained, bytes.size());
  evidence.text = fmt::format("{} lines of numbers, as a text gyro prints them", evidence.messages);
  if (evidence.messages < 2) evidence.role.reset();
  return evidence;
}

}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes) {
  Evidence best{.text = bytes.empty() ? "silent"
                                      : fmt::format("{} bytes that no known device sends", bytes.size())};
  for (const Evidence& evidence :
       {as_camera(bytes), as_witmotion(bytes), as_servo(bytes), as_text_gyro(bytes)}) {
    const bool convincing = evidence.role && evidence.explained_share >= share_needed;
    if (convincing && evidence.explained_share > best.explained_share) best = evidence;
  }
  return best;
}

}  // namespace thermorig::rig

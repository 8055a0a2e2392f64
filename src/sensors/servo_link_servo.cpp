// SPDX-License-Identifier: MIT
// The servo's micro-controller. Source: protocols/servo_link.md.
#include "thermorig/sensors/servo_protocol.h"

#include <fmt/format.h>

#include <array>

#include "servo_link.h"

namespace thermorig::sensors {

namespace {

constexpr std::uint64_t frame_bytes_around = 6;  // type, sequence, CRC, two flags
constexpr std::size_t messages_needed = 2;
// Long: an Arduino boots for a second or two after its port was opened.
constexpr std::array<UsualBaud, 1> servo_bauds{{{SERVO_LINK_BAUD, 0.38}}};
constexpr ClockProperties micro_controller_clock{
    .tick_s = 1e-6,
    .wrap_ticks = std::uint64_t{1} << 32U,
    .rate_error_max = 0.02};  // a ceramic resonator is within 0.5 %, an RC oscillator within 2 %

ServoScanner servo_scanner(const ServoProfile&) {
  return ServoScanner(wire::ServoScanner());
}

std::optional<Evidence> recognise_servo(std::span<const std::uint8_t> bytes) {
  wire::ServoScanner scanner;
  std::vector<wire::ServoMessage> messages;
  scanner.push(bytes, messages);
  if (messages.size() < messages_needed) return std::nullopt;
  Evidence evidence{.messages = messages.size(),
                    .bytes = scanner.counters().bytes_in_messages,
                    .text = fmt::format("{} messages of the servo link", messages.size()),
                    .text_format = {}};
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text = fmt::format("answers of a servo board (firmware {})", welcome->firmware);
  return evidence;
}

std::vector<std::uint8_t> hello() {
  return wire::hello_bytes(0);
}

}  // namespace

ServoProtocol servo_link_servo() {
  return {.name = "servo-link",
          .sends = "messages of the servo link",
          .greeted_as = "hello",
          .bauds = servo_bauds,
          .is_silent = false,
          .clock = micro_controller_clock,
          .message_bytes = SERVO_TELEMETRY_SIZE + frame_bytes_around,
          .rate_hz = 1e3 / SERVO_TELEMETRY_PERIOD_MS,
          .longest_gap_s = 0.05,
          .shaft_sensor = "AS5600",
          .scanner = servo_scanner,
          .recognise = recognise_servo,
          .greeting = hello,
          .emergency_bytes = wire::stop_bytes};
}

}  // namespace thermorig::sensors

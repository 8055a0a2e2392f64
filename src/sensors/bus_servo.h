// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framed_scanner.h"
#include "thermorig/sensors/evidence.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::sensors {

/// Between two telemetry messages: a host that is busy for so long has sent the servo nothing else meanwhile.
inline constexpr double longest_silence_of_a_host_s = 0.12;

/// What a packet of a servo on a bus holds. Telemetry and what the shaft does stand in one.
struct BusServoContent {
  using Message = wire::ServoMessage;
  FrameKind kind = FrameKind::reply;
  std::optional<wire::ServoBody> body = {};
  std::optional<ShaftReading> shaft = {};
  std::uint64_t before_shaft = 0;  // bytes of the packet that stand before the measured position
  std::optional<wire::ServoReply> trouble = {};

  void append_to(std::vector<Message>& out, const StreamSpan& span, bool gap) && {
    if (!body) return;
    // Two messages have no byte in common.
    StreamSpan left = span;
    if (trouble) {
      out.push_back({.body = *std::move(trouble), .span = {left.begin, left.begin + 1}});
      ++left.begin;
    }
    const StreamSpan of_state{left.begin, shaft ? span.begin + before_shaft : left.end};
    out.push_back({.body = *std::move(body), .span = of_state, .lost_before = gap});
    if (shaft) out.push_back({.body = *shaft, .span = {of_state.end, left.end}, .lost_before = gap});
  }
};

/// Which leg telemetry belongs to: the one that was noted before it was asked for.
class NotedLegs {
 public:
  void noted(std::span<const std::uint8_t> two_bytes) {
    noted_ = static_cast<std::uint16_t>(two_bytes[0] | two_bytes[1] << 8);
  }
  void asked() { asked_ = noted_; }
  void restart() { noted_ = asked_ = 0; }
  std::uint16_t of_telemetry() const { return asked_; }

 private:
  std::uint16_t noted_ = 0, asked_ = 0;
};

/// Of a measured angle: its count's own, and what the shaft turns in the time that it may be late.
inline float reading_uncertainty_deg(double count_deg, double rate_dps, double late_s) {
  return static_cast<float>(std::hypot(count_deg, rate_dps * late_s) / std::sqrt(12.0));
}

/// Whom the answers were from.
struct HeardServos {
  std::uint64_t answers = 0;
  std::uint8_t last_id = 0;
};

/// Of a Framing that says in sent() what was sent to the servo, and in heard() who answered.
template <typename Framing>
class BusServoScanner : public FramedScanner<Framing> {
 public:
  explicit BusServoScanner(int id) : FramedScanner<Framing>(Framing(static_cast<std::uint8_t>(id))) {}

  void sent(wire::Bytes bytes) {
    while (const auto size = Framing::size(bytes)) {
      if (*size == 0 || *size > bytes.size()) return;
      if (Framing::is_good(bytes.first(*size))) this->framing().sent(bytes.first(*size));
      bytes = bytes.subspan(*size);
    }
  }
};

/// What comes back from an adapter that echoes proves nothing. `sends`: "status packets (...)".
template <typename Framing>
std::optional<Evidence> recognise_bus_servo(wire::Bytes bytes, const std::string& sends) {
  BusServoScanner<Framing> scanner(0);
  std::vector<wire::ServoMessage> messages;
  scanner.push(bytes, messages);
  scanner.finish(messages);
  const HeardServos& heard = scanner.framing().heard();
  if (heard.answers == 0) return std::nullopt;
  Evidence evidence{.messages = heard.answers,
                    .bytes = scanner.counters().bytes_in_messages,
                    .text = fmt::format("{} {}, ID {}", heard.answers, sends, heard.last_id),
                    .text_format = {}};
  evidence.settings["bus_id"] = heard.last_id;
  for (const wire::ServoMessage& message : messages)
    if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
      evidence.text =
          fmt::format("answers of a servo (firmware {}, ID {})", welcome->firmware, welcome->board);
  return evidence;
}

}  // namespace thermorig::sensors

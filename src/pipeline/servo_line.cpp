// SPDX-License-Identifier: MIT
#include "servo_line.h"

#include <utility>
#include <variant>

namespace thermorig::pipeline {

ServoLine::ServoLine(const ServoProfile& profile) : timing_(profile.link) {}

std::span<const TimedServo> ServoLine::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                            Streams& out) {
  const std::size_t first = out.servo.size();
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  for (wire::ServoMessage& message : messages_) sort(std::move(message), out);
  messages_.clear();
  return std::span(out.servo).subspan(first);
}

void ServoLine::sort(wire::ServoMessage&& message, Streams& out) {
  const Stamp stamp = timing_.stamp(message.span);
  if (const auto* state = std::get_if<ServoState>(&message.body))
    out.servo.push_back(timed(message, *state, stamp));
  else if (const auto* pong = std::get_if<wire::ServoPong>(&message.body))
    out.pongs.push_back({.token = pong->token,
                         .receive_us = pong->receive_us,
                         .send_us = pong->send_us,
                         .span = message.span,
                         .arrival = stamp.arrival});
  else
    out.servo_answers.push_back(std::move(message));
}

TimedServo ServoLine::timed(const wire::ServoMessage& message, const ServoState& state, const Stamp& stamp) {
  return {.state = state,
          .span = message.span,
          .stamp = stamp,
          .mcu_time_us = mcu_time_.unwrap(state.mcu_us, stamp.time),
          .lost_before = message.lost_before};
}

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#include "servo_decoder.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace thermorig::pipeline {

namespace {
/// Of the host's microseconds in 32 bits, where a servo has no time of its own.
constexpr ClockProperties arrival_clock{.tick_s = 1e-6, .wrap_ticks = std::uint64_t{1} << 32U};

ClockProperties clock_of(const ServoProfile& profile) {
  return sensors::servo_protocol(profile.protocol).clock;
}
}  // namespace

ServoDecoder::ServoDecoder(const ServoProfile& profile, const Fits& fits)
    : link_(profile.link),
      scanner_(sensors::servo_protocol(profile.protocol).scanner(profile)),
      timing_(profile.link),
      final_times_(fits.times[Device::servo]),
      baud_(profile.link.baud),
      sends_time_(clock_of(profile).sends_time()),
      mcu_time_(sends_time_ ? clock_of(profile) : arrival_clock),
      pings_(profile.link.baud),
      clock_(profile.link),
      is_causal_(fits.times[Device::servo].empty()) {}

void ServoDecoder::sent(std::span<const std::uint8_t> bytes, HostTime before_write) {
  pings_.sent(bytes, before_write);
  scanner_.sent(bytes);
}

std::span<const TimedServo> ServoDecoder::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                               Streams& out) {
  newest_arrival_ = std::max(newest_arrival_, arrived);
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

std::span<const TimedServo> ServoDecoder::finish(Streams& out) {
  scanner_.finish(messages_);
  return take(out);
}

void ServoDecoder::interrupt(Streams& out) {
  finish(out);
  scanner_.restart();
  timing_.restart();
  mcu_time_.restart();
  clock_ = timing::PingClock(link_);
  epochs_told_ = 1;
  was_away_ = was_away_ || telemetry_.has_value();
  telemetry_.reset();
}

std::span<const TimedServo> ServoDecoder::take(Streams& out) {
  const std::size_t first = out.servo.size();
  for (wire::ServoMessage& message : messages_) sort(std::move(message), out);
  messages_.clear();
  const auto& epochs = clock_.epochs();
  for (; epochs_told_ < epochs.size(); ++epochs_told_) out.servo_epochs.push_back(epochs[epochs_told_]);
  return std::span(out.servo).subspan(first);
}

void ServoDecoder::sort(wire::ServoMessage&& message, Streams& out) {
  if (const auto* state = std::get_if<ServoState>(&message.body))
    out.servo.push_back(timed(message, *state));
  else if (const auto* pong = std::get_if<wire::ServoPong>(&message.body))
    out.pongs.push_back(timed(message, *pong));
  else
    out.servo_answers.push_back(std::move(message));
}

TimedServo ServoDecoder::timed(const wire::ServoMessage& message, const ServoState& state) {
  const Stamp stamp = timing_.stamp(message.span);
  const auto arrival_us = static_cast<std::uint32_t>(to_ns(stamp.time) / 1000);
  TimedServo servo{.state = state,
                   .span = message.span,
                   .stamp = stamp,
                   .mcu_time_us = mcu_time_.unwrap(sends_time_ ? state.mcu_us : arrival_us, stamp.time),
                   .lost_before = std::exchange(was_away_, false) || message.lost_before};
  if (!sends_time_) servo.state.mcu_us = arrival_us;
  if (is_causal_)
    stamp_by_clock(servo, begun_by(message.span));
  else
    final_times_.put_next(servo.stamp);
  telemetry_ = servo;
  return servo;
}

TimedPong ServoDecoder::timed(const wire::ServoMessage& message, const wire::ServoPong& pong) {
  const TimedPong timed{.token = pong.token,
                        .receive_us = pong.receive_us,
                        .send_us = pong.send_us,
                        .span = message.span,
                        .arrival = timing_.stamp(message.span).arrival};
  if (is_causal_) learn(timed, begun_by(message.span));
  return timed;
}

/// Until a ping has been answered the arrival is all there is.
void ServoDecoder::stamp_by_clock(TimedServo& servo, HostTime not_after) {
  clock_.sent({.send_us = servo.mcu_time_us, .not_after = not_after});
  const auto estimate = clock_.at(servo.mcu_time_us);
  if (estimate) put(*estimate, servo.stamp);
}

void ServoDecoder::learn(const TimedPong& pong, HostTime not_after) {
  if (!telemetry_) return;
  const auto exchange = pings_.exchange(pong, *telemetry_, not_after);
  if (exchange) clock_.exchange(*exchange);
}

/// The bytes from its first one on were through when the newest chunk was read.
HostTime ServoDecoder::begun_by(const StreamSpan& span) const {
  const std::uint64_t bytes = scanner_.counters().bytes_received - span.begin;
  return newest_arrival_ - from_s(timing::shortest_wire_time_s(bytes, baud_));
}

}  // namespace thermorig::pipeline

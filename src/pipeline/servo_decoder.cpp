// SPDX-License-Identifier: MIT
#include "servo_decoder.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace thermorig::pipeline {

namespace {
/// Of the host's microseconds in 32 bits, where a servo has no time of its own.
constexpr ClockProperties arrival_clock{.tick_s = 1e-6, .wrap_ticks = std::uint64_t{1} << 32U};

/// Of a request beyond its wire time: USB sends once a millisecond. A constant beside it is calibrated.
constexpr auto usual_way_out = std::chrono::microseconds(500);

const sensors::ServoProtocol& protocol_of(const ServoProfile& profile) {
  return sensors::servo_protocol(profile.protocol);
}

/// What was read as soon as it was asked for, where its answer came later than that. Where it may answer a
/// later request, it keeps the time of its arrival.
void put_request(const timing::ReadLedger::Request& request, Stamp& stamp) {
  const HostTime time = request.asked + usual_way_out;
  if (time >= stamp.time) return;
  if (!request.is_only) {
    stamp.earlier_s = static_cast<float>(to_s(stamp.time - request.asked));
    stamp.uncertainty_s = std::max(stamp.uncertainty_s, stamp.earlier_s / 2.0F);
    return;
  }
  stamp.later_s += static_cast<float>(to_s(stamp.time - time));
  stamp.earlier_s = stamp.uncertainty_s = static_cast<float>(to_s(usual_way_out));
  stamp.time = time;
}

std::vector<std::uint8_t> request_bytes(const ServoProfile& profile) {
  auto* const request = protocol_of(profile).telemetry_request;
  return request == nullptr ? std::vector<std::uint8_t>() : request(profile);
}

/// Readings may lie a little before the telemetry that came before them; the clock may have wrapped.
std::int64_t since_telemetry_us(const TimedServo& telemetry, std::uint32_t mcu_us,
                                const ClockProperties& clock) {
  const auto wrap_us = std::llround(static_cast<double>(clock.wrap_ticks) * clock.tick_s * 1e6);
  const std::int64_t since_us = (std::int64_t{mcu_us} - telemetry.state.mcu_us) % wrap_us;
  if (since_us > wrap_us / 2) return since_us - wrap_us;
  return since_us < -wrap_us / 2 ? since_us + wrap_us : since_us;
}

}  // namespace

ServoDecoder::ServoDecoder(const ServoProfile& profile, const EncoderProfile& encoder, const Fits& fits)
    : link_(profile.link),
      scanner_(protocol_of(profile).scanner(profile)),
      timing_(profile.link),
      final_times_(fits.times[Device::servo]),
      baud_(profile.link.baud),
      sends_time_(protocol_of(profile).clock.sends_time()),
      telemetry_request_(request_bytes(profile)),
      mcu_clock_(sends_time_ ? protocol_of(profile).clock : arrival_clock),
      mcu_time_(mcu_clock_),
      pings_(profile.link.baud),
      clock_(profile.link),
      is_causal_(fits.times[Device::servo].empty()),
      rate_scale_(fits.servo_rate_scale),
      encoder_latency_(from_s(encoder.latency_s)),
      turns_(encoder) {}

void ServoDecoder::sent(std::span<const std::uint8_t> bytes, HostTime before_write) {
  pings_.sent(bytes, before_write);
  scanner_.sent(bytes);
  if (!telemetry_request_.empty() && std::ranges::equal(bytes, telemetry_request_))
    reads_.asked(before_write + from_s(shortest_wire_time_s(bytes.size(), baud_)));
}

ServoDecoder::Decoded ServoDecoder::push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                         Streams& out) {
  newest_arrival_ = std::max(newest_arrival_, arrived);
  scanner_.push(chunk, messages_);
  timing_.chunk(scanner_.counters().bytes_received, arrived);
  return take(out);
}

ServoDecoder::Decoded ServoDecoder::finish(Streams& out) {
  scanner_.finish(messages_);
  return take(out);
}

void ServoDecoder::interrupt(Streams& out) {
  finish(out);
  scanner_.restart();
  timing_.restart();
  mcu_time_.restart();
  clock_ = timing::PingClock(link_);
  reads_.restart();
  epochs_passed_on_ = 1;
  was_away_ = was_away_ || telemetry_.has_value();
  telemetry_.reset();
  turns_.restart();
}

ServoDecoder::Decoded ServoDecoder::take(Streams& out) {
  const std::size_t first = out.servo.size(), first_reading = out.shaft.size();
  for (wire::ServoMessage& message : messages_) sort(std::move(message), out);
  messages_.clear();
  const auto& epochs = clock_.epochs();
  for (; epochs_passed_on_ < epochs.size(); ++epochs_passed_on_)
    out.servo_epochs.push_back(epochs[epochs_passed_on_]);
  return {std::span(out.servo).subspan(first), std::span(out.shaft).subspan(first_reading)};
}

void ServoDecoder::sort(wire::ServoMessage&& message, Streams& out) {
  if (const auto* state = std::get_if<ServoState>(&message.body))
    out.servo.push_back(timed(message, *state));
  else if (const auto* pong = std::get_if<wire::ServoPong>(&message.body))
    out.pongs.push_back(timed(message, *pong));
  else if (const auto* reading = std::get_if<ShaftReading>(&message.body)) {
    // Before telemetry has come its time is not known.
    if (telemetry_ && is_placed_) out.shaft.push_back(timed(message, *reading));
  } else
    out.servo_answers.push_back(std::move(message));
}

TimedServo ServoDecoder::timed(const wire::ServoMessage& message, const ServoState& state) {
  Stamp stamp = timing_.stamp(message.span);
  const auto request = reads_.answered(begun_by(message.span));
  if (request && !sends_time_) put_request(*request, stamp);
  is_placed_ = sends_time_ || !request || request->is_only;
  const auto arrival_us = static_cast<std::uint32_t>(to_ns(stamp.time) / 1000);
  TimedServo servo{.state = state,
                   .span = message.span,
                   .stamp = stamp,
                   .mcu_time_us = mcu_time_.unwrap(sends_time_ ? state.mcu_us : arrival_us, stamp.time),
                   .lost_before = std::exchange(was_away_, false) || message.lost_before};
  if (!sends_time_) servo.state.mcu_us = arrival_us;
  servo.state.rate_dps *= rate_scale_;
  if (is_causal_) {
    if (request && request->is_only && sends_time_)
      learn_of_answer(servo, request->asked, begun_by(message.span));
    stamp_by_clock(servo, begun_by(message.span));
  } else {
    final_times_.put_next(servo.stamp);
  }
  if (telemetry_) host_s_per_us_ = host_s_per_us(*telemetry_, servo);
  telemetry_ = servo;
  return servo;
}

/// By the telemetry before it, with which it shares a clock.
TimedShaft ServoDecoder::timed(const wire::ServoMessage& message, const ShaftReading& reading) {
  const std::int64_t since_us = sends_time_ ? since_telemetry_us(*telemetry_, reading.mcu_us, mcu_clock_) : 0;
  TimedShaft shaft{.reading = reading,
                   .span = message.span,
                   .stamp = telemetry_->stamp,
                   .mcu_time_us = telemetry_->mcu_time_us + since_us};
  shaft.stamp.arrival = timing_.stamp(message.span).arrival;
  const auto estimate = is_causal_ ? clock_.at(shaft.mcu_time_us) : std::nullopt;
  if (estimate)
    put(*estimate, shaft.stamp);
  else
    shaft.stamp.time += from_s(static_cast<double>(since_us) * host_s_per_us_);
  shaft.stamp.time -= encoder_latency_;
  turns_.count(message.lost_before, shaft);
  return shaft;
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
  clock_.feed(timing::sent_at(servo.mcu_time_us, not_after));
  const auto estimate = clock_.at(servo.mcu_time_us);
  if (estimate) put(*estimate, servo.stamp);
}

/// Its time is that of the instant at which it was asked, cut off to its tick.
void ServoDecoder::learn_of_answer(const TimedServo& servo, HostTime asked, HostTime not_after) {
  const std::int64_t tick_us = std::llround(1e6 * mcu_clock_.tick_s);
  const std::int64_t at_most_us = servo.mcu_time_us + tick_us;
  clock_.feed({.receive_us = at_most_us,
               .not_before = asked,
               .send_us = at_most_us,
               .not_after = not_after + std::chrono::microseconds(tick_us)});
}

void ServoDecoder::learn(const TimedPong& pong, HostTime not_after) {
  if (!telemetry_) return;
  const auto exchange = pings_.exchange(pong, *telemetry_, not_after);
  if (exchange) clock_.feed(*exchange);
}

/// The bytes from its first one on were through when the newest chunk was read.
HostTime ServoDecoder::begun_by(const StreamSpan& span) const {
  const std::uint64_t bytes = scanner_.counters().bytes_received - span.begin;
  return newest_arrival_ - from_s(shortest_wire_time_s(bytes, baud_));
}

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

namespace {

/// Takes little-endian numbers from a payload, in the order in which protocols/servo_link.h declares them.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::uint8_t> payload) : at_(payload.data()) {}

  std::uint8_t u8() { return *at_++; }
  std::uint16_t u16() {
    at_ += 2;
    return servo_get_u16(at_ - 2);
  }
  std::uint32_t u32() {
    at_ += 4;
    return servo_get_u32(at_ - 4);
  }
  double hundredths() { return static_cast<std::int32_t>(u32()) / 100.0; }  // i32 centi-units

 private:
  const std::uint8_t* at_;
};

ServoState read_telemetry(PayloadReader in) {
  ServoState state;
  state.mcu_us = in.u32();
  state.angle_deg = in.hundredths();
  state.rate_dps = in.hundredths();
  const std::uint16_t pulse_ticks = in.u16();
  const std::uint8_t motion = in.u8();
  const bool fine = (motion & SERVO_FINE_TICKS) != 0;
  const unsigned ticks_per_us = fine ? SERVO_TICKS_PER_US : SERVO_COARSE_TICKS_PER_US;
  state.pulse_us = static_cast<float>(pulse_ticks) / static_cast<float>(ticks_per_us);
  state.motion = static_cast<ServoMotion>(motion & ~SERVO_FINE_TICKS);
  state.fault = static_cast<ServoFault>(in.u8());
  state.leg = in.u16();
  return state;
}

ServoWelcome read_welcome(PayloadReader in) {
  ServoWelcome welcome;
  welcome.version = in.u8();
  const unsigned major = in.u8();
  const unsigned minor = in.u8();
  const unsigned patch = in.u8();
  welcome.firmware = fmt::format("{}.{}.{}", major, minor, patch);
  welcome.board = in.u8();
  welcome.reset_cause = in.u8();
  welcome.uptime_us = in.u32();
  welcome.limit_pulse_min_us = in.u16();
  welcome.limit_pulse_max_us = in.u16();
  welcome.limit_rate_dps = in.u32() / 100.0;
  welcome.limit_acceleration_dps2 = in.u16();
  welcome.watchdog_ms = in.u16();
  return welcome;
}

ServoAck read_ack(PayloadReader in) {
  ServoAck ack;
  ack.type = in.u8();
  ack.mcu_us = in.u32();
  return ack;
}

ServoNack read_nack(PayloadReader in) {
  ServoNack nack;
  nack.type = in.u8();
  nack.reason = in.u8();
  nack.detail = in.u8();
  return nack;
}

ServoPong read_pong(PayloadReader in) {
  ServoPong pong;
  pong.token = in.u32();
  pong.receive_us = in.u32();
  pong.send_us = in.u32();
  return pong;
}

ServoEvent read_event(PayloadReader in) {
  ServoEvent event;
  event.kind = in.u8();
  event.detail = in.u16();
  event.mcu_us = in.u32();
  return event;
}

/// An AS5600's steps; what they and its noise, as our CONF has it, make of one reading: 0.025 and 0.043 deg.
ShaftReading read_shaft(PayloadReader in) {
  ShaftReading reading;
  reading.mcu_us = in.u32();
  reading.angle_deg = in.u16() * (360.0 / SERVO_SHAFT_STEPS);
  reading.uncertainty_deg = 0.05F;
  const std::uint8_t status = in.u8();
  const auto has = [status](unsigned bits) { return (status & bits) != 0; };
  reading.status = has(SERVO_SHAFT_UNREAD)          ? ShaftStatus::silent
                   : !has(SERVO_SHAFT_MAGNET_FOUND) ? ShaftStatus::absent
                   : has(SERVO_SHAFT_MAGNET_STRONG) ? ShaftStatus::strong
                   : has(SERVO_SHAFT_MAGNET_WEAK)   ? ShaftStatus::weak
                                                    : ShaftStatus::good;
  reading.gain = in.u8();
  return reading;
}

/// A raw angle beyond the turn is no angle.
std::optional<ServoBody> read_known_shaft(PayloadReader in) {
  const ShaftReading reading = read_shaft(in);
  if (reading.angle_deg >= reading.turn_deg) return std::nullopt;
  return reading;
}

/// The first byte is the version in every version of the link; the rest may have changed.
bool is_foreign_welcome(std::uint8_t type, std::span<const std::uint8_t> payload) {
  return type == SERVO_WELCOME && !payload.empty() && payload[0] != SERVO_LINK_VERSION;
}

/// Telemetry whose motion or fault this version of the link does not know says nothing certain.
std::optional<ServoBody> read_known_telemetry(PayloadReader in) {
  const ServoState state = read_telemetry(in);
  if (state.motion > ServoMotion::stopping || state.fault > ServoFault::bad_frames) return std::nullopt;
  return state;
}

/// Stands for itself inside a frame.
bool is_plain(std::uint8_t byte) {
  return byte != SERVO_LINK_FLAG && byte != SERVO_LINK_ESCAPE && byte != SERVO_LINK_STOP;
}

/// Length of the payload of a message from the servo; 0 for a type that it does not send.
std::size_t servo_payload_size(std::uint8_t type) {
  switch (type) {
    case SERVO_WELCOME:
      return SERVO_WELCOME_SIZE;
    case SERVO_ACK:
      return SERVO_ACK_SIZE;
    case SERVO_NACK:
      return SERVO_NACK_SIZE;
    case SERVO_TELEMETRY:
      return SERVO_TELEMETRY_SIZE;
    case SERVO_PONG:
      return SERVO_PONG_SIZE;
    case SERVO_EVENT:
      return SERVO_EVENT_SIZE;
    case SERVO_SHAFT:
      return SERVO_SHAFT_SIZE;
    default:
      return 0;
  }
}

/// The message in the payload of a good frame; none if the servo sends no such type, not of this length, or
/// not with these values.
std::optional<ServoBody> read_servo_payload(std::uint8_t type, std::span<const std::uint8_t> payload) {
  if (is_foreign_welcome(type, payload)) return ServoWelcome{.version = payload[0]};
  if (payload.size() != servo_payload_size(type)) return std::nullopt;
  const PayloadReader in(payload);
  switch (type) {
    case SERVO_WELCOME:
      return read_welcome(in);
    case SERVO_ACK:
      return read_ack(in);
    case SERVO_NACK:
      return read_nack(in);
    case SERVO_TELEMETRY:
      return read_known_telemetry(in);
    case SERVO_PONG:
      return read_pong(in);
    case SERVO_EVENT:
      return read_event(in);
    case SERVO_SHAFT:
      return read_known_shaft(in);
    default:
      return std::nullopt;
  }
}

}  // namespace

ServoScanner::ServoScanner() {
  servo_decoder_reset(&decoder_);
}

void ServoScanner::push(std::span<const std::uint8_t> bytes, std::vector<ServoMessage>& out) {
  assert(!ended_);
  while (!bytes.empty()) {
    const std::size_t plain = take_plain(bytes);
    if (plain == 0) take(bytes.front(), out);
    bytes = bytes.subspan(std::max<std::size_t>(plain, 1));
  }
}

void ServoScanner::finish(std::vector<ServoMessage>&) {
  ended_ = true;
}

void ServoScanner::restart() {
  const ByteLedger ledger = ledger_;
  *this = ServoScanner();
  ledger_ = ledger;
  ledger_.restart();
}

/// Nearly all bytes only make an open frame longer: there is nothing to decide about them. Returns how many.
std::size_t ServoScanner::take_plain(std::span<const std::uint8_t> bytes) {
  const bool is_inside = decoder_.in_frame && !decoder_.ended && !decoder_.escaped;
  const std::size_t room = is_inside ? SERVO_BODY_MAX - decoder_.size : 0;
  const auto within = bytes.first(std::min(room, bytes.size()));
  const auto end = std::find_if_not(within.begin(), within.end(), is_plain);
  const auto count = static_cast<std::size_t>(end - within.begin());
  std::copy(within.begin(), end, decoder_.body + decoder_.size);
  decoder_.size = static_cast<std::uint8_t>(decoder_.size + count);
  ledger_.receive(count);
  return count;
}

/// Bytes of a frame that has not ended wait as pending; an overlong one is booked as damaged while it lasts.
void ServoScanner::take(std::uint8_t byte, std::vector<ServoMessage>& out) {
  ledger_.receive(1);
  const bool was_open = is_open();
  const bool was_overlong = decoder_.overlong;
  switch (servo_decoder_push(&decoder_, byte)) {
    case SERVO_DECODED_NOTHING:
      return take_nothing(byte, was_overlong);
    case SERVO_DECODED_OUTSIDE:
      return ledger_.book_gap(1);
    case SERVO_DECODED_FRAME:
      return take_frame(out);
    case SERVO_DECODED_BAD:
      return take_damaged(was_overlong);
    case SERVO_DECODED_STOP:
      return take_stop(was_open, was_overlong);
  }
}

bool ServoScanner::is_open() const {
  return decoder_.in_frame && !decoder_.ended && (decoder_.size > 0 || decoder_.escaped);
}

void ServoScanner::take_nothing(std::uint8_t byte, bool was_overlong) {
  if (byte == SERVO_LINK_FLAG) {  // it opens a frame; a flag before it was an idle one
    ledger_.book_filler(ledger_.waiting() - 1);
  } else if (decoder_.overlong) {
    if (!was_overlong) ++ledger_.counters.bad_length;
    book_damage(ledger_.waiting());
  }
}

void ServoScanner::take_frame(std::vector<ServoMessage>& out) {
  const std::uint8_t type = decoder_.body[0];
  const std::span payload(decoder_.body + 2, servo_decoder_payload_size(&decoder_));
  std::optional<ServoBody> body = read_servo_payload(type, payload);
  if (!body) {
    const std::size_t size = servo_payload_size(type);
    const bool wrong_length = size != 0 && size != payload.size();
    ++(wrong_length ? ledger_.counters.bad_length : ledger_.counters.bad_value);
    return book_damage(ledger_.waiting());
  }
  ServoMessage message{std::move(*body), decoder_.body[1], {}, false};
  message.lost_before = find_loss(message);
  message.span = ledger_.book_message(ledger_.waiting());
  ++(std::holds_alternative<ServoState>(message.body) ? ledger_.counters.messages : ledger_.counters.replies);
  out.push_back(std::move(message));
}

/// The flag that ends a damaged frame may as well open the next one: it stays pending.
void ServoScanner::take_damaged(bool was_overlong) {
  if (!was_overlong) ++ledger_.counters.bad_checksum;
  book_damage(ledger_.waiting() - 1);
}

/// The servo never sends a stop byte: noise, which throws away the frame around it.
void ServoScanner::take_stop(bool was_open, bool was_overlong) {
  if (was_open && !was_overlong) {
    ++ledger_.counters.bad_checksum;
    ledger_.mark_damage(ledger_.waiting() - 1);
  }
  ledger_.book_gap(ledger_.waiting());
}

void ServoScanner::book_damage(std::uint64_t bytes) {
  if (bytes == 0) return;
  ledger_.mark_damage(bytes);
  ledger_.book_gap(bytes);
}

/// Telemetry, events and readings of the shaft each count their own sequence, from 0 after a reset. The same
/// telemetry again is a repeated frame, not 255 lost ones. Answers carry their command's number, which says
/// nothing about losses.
bool ServoScanner::find_loss(const ServoMessage& message) {
  const bool gap = ledger_.take_gap();
  if (const auto* state = std::get_if<ServoState>(&message.body)) {
    const bool repeated = telemetry_sequence_ == message.sequence && telemetry_mcu_us_ == state->mcu_us;
    telemetry_mcu_us_ = state->mcu_us;
    return !repeated && count_missing(telemetry_sequence_, message.sequence);
  }
  if (std::holds_alternative<ShaftReading>(message.body))
    return count_missing(shaft_sequence_, message.sequence);
  if (const auto* event = std::get_if<ServoEvent>(&message.body)) {
    if (event->kind == SERVO_EVENT_RESET) {
      telemetry_sequence_.reset();
      shaft_sequence_.reset();
      event_sequence_.reset();
    }
    return count_missing(event_sequence_, message.sequence);
  }
  return gap;
}

bool ServoScanner::count_missing(std::optional<std::uint8_t>& before, std::uint8_t sequence) {
  const std::optional<std::uint8_t> last = std::exchange(before, sequence);
  if (!last) return false;
  const auto missing = static_cast<std::uint8_t>(sequence - *last - 1);
  ledger_.counters.lost += missing;
  return missing > 0;
}

}  // namespace thermorig::wire

// SPDX-License-Identifier: MIT
#include <cassert>
#include <utility>

#include "servo_payload.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

ServoScanner::ServoScanner() {
  servo_decoder_reset(&decoder_);
}

void ServoScanner::push(std::span<const std::uint8_t> bytes, std::vector<ServoMessage>& out) {
  assert(!ended_);
  for (const std::uint8_t byte : bytes) take(byte, out);
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

/// Telemetry and events each count their own sequence, from 0 after a reset. The same telemetry again is a
/// repeated frame, not 255 lost ones. Answers carry their command's number, which says nothing about losses.
bool ServoScanner::find_loss(const ServoMessage& message) {
  const bool gap = ledger_.take_gap();
  if (const auto* state = std::get_if<ServoState>(&message.body)) {
    const bool repeated = telemetry_sequence_ == message.sequence && telemetry_mcu_us_ == state->mcu_us;
    telemetry_mcu_us_ = state->mcu_us;
    return !repeated && count_missing(telemetry_sequence_, message.sequence);
  }
  if (const auto* event = std::get_if<ServoEvent>(&message.body)) {
    if (event->kind == SERVO_EVENT_RESET) {
      telemetry_sequence_.reset();
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

// SPDX-License-Identifier: MIT
#include "thermorig/wire/camera_scanner.h"

#include <cassert>

#include "checksums.h"
#include "gy_mcu90640.h"
#include "reassembly.h"

namespace thermorig::wire {

namespace {

static_assert(gy_mcu90640::pixels == frame_pixels);

bool is_frame_header(Bytes rest) {
  return rest[0] == gy_mcu90640::sync && rest[1] == gy_mcu90640::sync &&
         u16_at(rest, gy_mcu90640::length_offset) == gy_mcu90640::frame_length;
}

/// A reply never ends in a sync byte (its emissivity would be above 1), so it cannot swallow a header.
bool is_reply(Bytes rest) {
  return rest[0] == gy_mcu90640::sync && rest[1] == gy_mcu90640::sync &&
         rest[2] <= gy_mcu90640::emissivity_max && rest[3] == byte_sum8(rest.first(3));
}

bool is_start(Bytes rest) {
  return is_frame_header(rest) || is_reply(rest);
}

float temp_c_at(Bytes rest, std::size_t at) {
  return static_cast<float>(i16_at(rest, at)) / static_cast<float>(gy_mcu90640::counts_per_kelvin);
}

void read_frame(Bytes rest, ThermalFrame& frame) {
  for (std::size_t i = 0; i < frame_pixels; ++i)
    frame.temp_c[i] = temp_c_at(rest, gy_mcu90640::pixels_offset + 2 * i);
  frame.sensor_temp_c = temp_c_at(rest, gy_mcu90640::sensor_temp_offset);
}

}  // namespace

CameraScanner::CameraScanner(ChecksumPolicy checksum) : checksum_(checksum) {}

void CameraScanner::push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out) {
  ledger_.receive(bytes.size());
  reassemble(pending_, bytes, bytes_to_decide(), [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

std::size_t CameraScanner::bytes_to_decide() const {
  const bool needs_next = checksum_ == ChecksumPolicy::ignore;
  return gy_mcu90640::frame_bytes + (needs_next ? gy_mcu90640::header_bytes : 0);
}

std::size_t CameraScanner::step(Bytes rest, std::vector<CameraMessage>& out) {
  if (rest[0] != gy_mcu90640::sync) return skip(bytes_before(gy_mcu90640::sync, rest));
  if (rest.size() > 1 && rest[1] != gy_mcu90640::sync) return skip(1);
  if (rest.size() < gy_mcu90640::header_bytes) return 0;
  if (is_frame_header(rest)) return take_frame(rest, out);
  // Inside a damaged frame, two sync bytes are a pixel of 231.30 degC: neither a reply nor a wrong length.
  if (!ledger_.in_damage()) {
    if (is_reply(rest)) return take_reply();
    if (rest[2] != gy_mcu90640::sync) ++ledger_.counters.bad_length;
  }
  return skip(1);
}

std::size_t CameraScanner::take_frame(Bytes rest, std::vector<CameraMessage>& out) {
  if (rest.size() < bytes_to_decide()) return 0;
  if (!is_good(rest)) {
    // Bytes may be missing from it, so the next header can stand anywhere inside: resume at the next byte.
    ++ledger_.counters.bad_checksum;
    ledger_.mark_damage(gy_mcu90640::frame_bytes);
    return skip(1);
  }
  CameraMessage& message = out.emplace_back();
  read_frame(rest, message.frame);
  message.resync_before = ledger_.take_gap();
  message.span = ledger_.book_message(gy_mcu90640::frame_bytes);
  ++ledger_.counters.messages;
  return gy_mcu90640::frame_bytes;
}

std::size_t CameraScanner::take_reply() {
  ledger_.book_message(gy_mcu90640::reply_bytes);
  ++ledger_.counters.replies;
  return gy_mcu90640::reply_bytes;
}

std::size_t CameraScanner::skip(std::size_t bytes) {
  ledger_.book_gap(bytes);
  return bytes;
}

bool CameraScanner::is_good(Bytes rest) const {
  const Bytes summed = rest.first(gy_mcu90640::checksum_offset);
  const std::uint16_t sent = u16_at(rest, gy_mcu90640::checksum_offset);
  switch (checksum_) {
    case ChecksumPolicy::word:
      return word_sum16(summed) == sent;
    case ChecksumPolicy::byte:
      return byte_sum16(summed) == sent;
    case ChecksumPolicy::ignore:
      break;
  }
  return is_start(rest.subspan(gy_mcu90640::frame_bytes, gy_mcu90640::header_bytes));
}

}  // namespace thermorig::wire

// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/camera_scanner.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "gy_mcu90640.h"
#include "interrupted_frame.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::wire {

namespace {

static_assert(gy_mcu90640::pixels == frame_pixels);
static_assert(gy_mcu90640::header_bytes == gy_mcu90640::reply_bytes);

// A frame, and the header or reply that may have to be seen with it.
constexpr std::size_t bytes_to_decide = gy_mcu90640::frame_bytes + gy_mcu90640::header_bytes;

bool is_frame_header(Bytes rest) {
  return rest[0] == gy_mcu90640::sync && rest[1] == gy_mcu90640::sync &&
         u16_at(rest, gy_mcu90640::length_offset) == gy_mcu90640::frame_length;
}

bool is_start(Bytes rest) {
  return is_frame_header(rest) || is_reply(rest);
}

/// Whether a stream that ends after fewer bytes than a header has may have been cut inside one.
bool may_be_cut_header(Bytes rest) {
  return std::all_of(rest.begin(),
                     rest.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(rest.size(), 2)),
                     [](std::uint8_t byte) { return byte == gy_mcu90640::sync; });
}

using Words = std::array<std::int16_t, frame_pixels>;

Words words_of(Bytes rest) {
  Words words;
  for (std::size_t i = 0; i < frame_pixels; ++i) words[i] = i16_at(rest, gy_mcu90640::pixels_offset + 2 * i);
  return words;
}

float temp_c_of(std::int16_t word) {
  return static_cast<float>(word) / static_cast<float>(gy_mcu90640::counts_per_kelvin);
}

}  // namespace

CameraScanner::CameraScanner(ChecksumPolicy checksum) : checksum_(checksum) {}

void CameraScanner::push(std::span<const std::uint8_t> bytes, std::vector<CameraMessage>& out) {
  assert(!ended_);
  ledger_.receive(bytes.size());
  reassemble(pending_, bytes, bytes_to_decide, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void CameraScanner::finish(std::vector<CameraMessage>& out) {
  ended_ = true;
  reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void CameraScanner::restart() {
  ledger_.restart();
  pending_.clear();
  freshness_.restart();
  ended_ = false;
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
  if (rest.size() < gy_mcu90640::frame_bytes) return 0;
  const Bytes frame = rest.first(gy_mcu90640::frame_bytes);
  const bool fits = checksum_fits(frame, checksum_);
  if (fits && checksum_ != ChecksumPolicy::ignore) return book_frame(frame, frame.size(), out);
  // The four bytes behind it decide: they vouch for a frame, or belong to one that a reply made longer.
  if (rest.size() < bytes_to_decide && !ended_) return 0;
  if (fits && is_start_or_end(rest.subspan(frame.size()))) return book_frame(frame, frame.size(), out);
  if (rest.size() >= bytes_to_decide && !fits)
    if (const auto at = find_reply_inside(rest.first(bytes_to_decide), checksum_))
      return take_interrupted_frame(rest.first(bytes_to_decide), *at, out);
  // Bytes may be missing from it, so the next header can stand anywhere inside: resume at the next byte.
  ++ledger_.counters.bad_checksum;
  ledger_.mark_damage(gy_mcu90640::frame_bytes);
  return skip(1);
}

std::size_t CameraScanner::book_frame(Bytes frame, std::size_t bytes, std::vector<CameraMessage>& out) {
  const Words words = words_of(frame);
  CameraMessage& message = out.emplace_back();
  std::transform(words.begin(), words.end(), message.frame.temp_c.begin(), temp_c_of);
  message.frame.sensor_temp_c = temp_c_of(i16_at(frame, gy_mcu90640::sensor_temp_offset));
  message.fresh = freshness_.push(words);
  message.resync_before = ledger_.take_gap();
  message.span = ledger_.book_message(bytes);
  ++ledger_.counters.messages;
  return bytes;
}

std::size_t CameraScanner::take_interrupted_frame(Bytes bytes, std::size_t reply_at,
                                                  std::vector<CameraMessage>& out) {
  std::array<std::uint8_t, gy_mcu90640::frame_bytes> frame{};
  const auto behind = std::copy_n(bytes.begin(), reply_at, frame.begin());
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(reply_at + gy_mcu90640::reply_bytes), bytes.end(),
            behind);
  ++ledger_.counters.replies;
  return book_frame(frame, bytes.size(), out);
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

bool CameraScanner::is_start_or_end(Bytes rest) const {
  return rest.size() < gy_mcu90640::header_bytes ? may_be_cut_header(rest) : is_start(rest);
}

}  // namespace thermorig::wire

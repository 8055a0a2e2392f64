// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/camera_scanner.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <optional>

#include "gy_mcu90640.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/wire/checksums.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::wire {

namespace {

constexpr std::size_t reply_bytes = gy_mcu90640::reply_bytes;
static_assert(reply_bytes % 2 == 0, "words behind a reply keep their low and high bytes apart");

std::uint16_t sum_of(Bytes bytes, ChecksumPolicy checksum) {
  return checksum == ChecksumPolicy::word ? word_sum16(bytes) : byte_sum16(bytes);
}

/// What the bytes of a reply that stands at `at` add to the sum of everything.
std::uint16_t share_of_reply(Bytes bytes, std::size_t at, ChecksumPolicy checksum) {
  std::uint32_t sum = 0;
  for (std::size_t i = at; i < at + reply_bytes; ++i)
    sum += checksum == ChecksumPolicy::word && i % 2 == 1 ? bytes[i] * 256U : bytes[i];
  return static_cast<std::uint16_t>(sum);
}

/// The check sum field of a frame whose first `before` bytes stand ahead of the reply.
std::uint16_t checksum_around(Bytes bytes, std::size_t before) {
  const auto at = [&](std::size_t offset) { return bytes[offset < before ? offset : offset + reply_bytes]; };
  return static_cast<std::uint16_t>(at(gy_mcu90640::checksum_offset) |
                                    (at(gy_mcu90640::checksum_offset + 1) << 8));
}

/// Four bytes that are a reply of the camera: sync, sync, emissivity, sum. It never ends in a sync byte (its
/// emissivity would be above 1), so it cannot swallow a header.
bool is_reply(Bytes rest) {
  return rest[0] == gy_mcu90640::sync && rest[1] == gy_mcu90640::sync &&
         rest[2] <= gy_mcu90640::emissivity_max && rest[3] == byte_sum8(rest.first(3));
}

/// Where a reply stands inside a frame that the bridge interrupted for it: taken out, the check sum fits.
/// `bytes` begin with a frame header and are as long as a frame and a reply. None under
/// ChecksumPolicy::ignore, which leaves nothing to decide by.
std::optional<std::size_t> find_reply_inside(Bytes bytes, ChecksumPolicy checksum) {
  if (checksum == ChecksumPolicy::ignore) return std::nullopt;
  constexpr std::size_t checksum_at = gy_mcu90640::checksum_offset;
  const std::uint16_t sum = sum_of(bytes.first(checksum_at + reply_bytes), checksum);
  const std::uint16_t sum_ahead = sum_of(bytes.first(checksum_at), checksum);
  for (std::size_t at = gy_mcu90640::header_bytes; at < gy_mcu90640::frame_bytes; ++at) {
    if (!is_reply(bytes.subspan(at, reply_bytes))) continue;
    const auto summed =
        static_cast<std::uint16_t>(at > checksum_at ? sum_ahead : sum - share_of_reply(bytes, at, checksum));
    if (summed == checksum_around(bytes, at)) return at;
  }
  return std::nullopt;
}

/// Whether the check sum of a whole frame fits. Always, under ChecksumPolicy::ignore.
bool checksum_fits(Bytes frame, ChecksumPolicy checksum) {
  return checksum == ChecksumPolicy::ignore || sum_of(frame.first(gy_mcu90640::checksum_offset), checksum) ==
                                                   u16_at(frame, gy_mcu90640::checksum_offset);
}

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
  ledger_.book_data(message, bytes);
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
  ledger_.book_reply(gy_mcu90640::reply_bytes);
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

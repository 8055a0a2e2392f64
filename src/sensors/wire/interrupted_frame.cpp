// SPDX-License-Identifier: MIT
#include "interrupted_frame.h"

#include <algorithm>

#include "gy_mcu90640.h"
#include "thermorig/sensors/wire/checksums.h"

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

}  // namespace

bool is_reply(Bytes rest) {
  return rest[0] == gy_mcu90640::sync && rest[1] == gy_mcu90640::sync &&
         rest[2] <= gy_mcu90640::emissivity_max && rest[3] == byte_sum8(rest.first(3));
}

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

bool checksum_fits(Bytes frame, ChecksumPolicy checksum) {
  return checksum == ChecksumPolicy::ignore || sum_of(frame.first(gy_mcu90640::checksum_offset), checksum) ==
                                                   u16_at(frame, gy_mcu90640::checksum_offset);
}

}  // namespace thermorig::wire

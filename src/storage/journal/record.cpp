// SPDX-License-Identifier: MIT
#include "record.h"

#include <zlib.h>

#include <algorithm>

#include "little_endian.h"

namespace thermorig::journal {

namespace {

constexpr std::array<std::uint8_t, 4> magic{'T', 'R', 'J', '1'};
constexpr std::size_t crc_offset = front_bytes - 4;

std::uint32_t crc_of(const FrontBytes& front, std::span<const std::span<const std::uint8_t>> payload) {
  uLong crc = ::crc32(0, front.data(), crc_offset);
  for (const auto part : payload)
    if (!part.empty()) crc = ::crc32(crc, part.data(), static_cast<uInt>(part.size()));
  return static_cast<std::uint32_t>(crc);
}

bool is_type(std::uint8_t type) {
  return type >= static_cast<std::uint8_t>(RecordType::header) &&
         type <= static_cast<std::uint8_t>(RecordType::estimates);
}

}  // namespace

FrontBytes encode_front(const RecordFront& front, std::span<const std::span<const std::uint8_t>> payload) {
  FrontBytes bytes{};
  std::copy(magic.begin(), magic.end(), bytes.begin());
  bytes[4] = static_cast<std::uint8_t>(front.type);
  bytes[5] = front.device;
  put_little_endian(&bytes[8], front.journal_id);
  put_little_endian(&bytes[16], front.sequence);
  put_little_endian(&bytes[24], front.length);
  put_little_endian(&bytes[crc_offset], crc_of(bytes, payload));
  return bytes;
}

std::optional<RecordFront> decode_front(const FrontBytes& bytes) {
  RecordFront front;
  if (!std::equal(magic.begin(), magic.end(), bytes.begin()) || !is_type(bytes[4])) return std::nullopt;
  front.type = static_cast<RecordType>(bytes[4]);
  front.device = bytes[5];
  front.journal_id = get_little_endian<std::uint64_t>(&bytes[8]);
  front.sequence = get_little_endian<std::uint64_t>(&bytes[16]);
  front.length = get_little_endian<std::uint32_t>(&bytes[24]);
  if (front.length > payload_max_bytes) return std::nullopt;
  return front;
}

bool has_magic(std::span<const std::uint8_t> bytes) {
  return std::equal(bytes.begin(),
                    bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), magic.size())),
                    magic.begin());
}

bool crc_is_good(const FrontBytes& bytes, std::span<const std::uint8_t> payload) {
  return crc_of(bytes, {&payload, 1}) == get_little_endian<std::uint32_t>(&bytes[crc_offset]);
}

}  // namespace thermorig::journal

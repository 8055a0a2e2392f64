// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/raw_recording.h"

namespace thermorig::journal {

/// Types of records. They are stored in files: never renumber them.
enum class RecordType : std::uint8_t {
  header = 1,
  received = 2,
  sent = 3,
  event = 4,
  leg = 5,
  end = 6,
  estimate = 7,  // of before format 2 of sessions: three estimators, in fixed places
  estimates = 8
};

/// The fixed front of every record, 32 bytes, little-endian; a CRC-32 of its first 28 bytes and of the
/// payload stands in its last four. Table: docs/journal_format.md.
struct RecordFront {
  RecordType type = RecordType::header;
  std::uint8_t device = 0;  // of a chunk that was received or sent, else 0
  std::uint64_t journal_id = 0;
  std::uint64_t sequence = 0;  // 0 for the header, then one more each record
  std::uint32_t length = 0;    // of the payload that follows, bytes
};

inline constexpr std::size_t front_bytes = 32;
inline constexpr std::uint32_t payload_max_bytes = 16U << 20U;
using FrontBytes = std::array<std::uint8_t, front_bytes>;

/// The front in bytes, its CRC computed over it and over the parts of the payload.
FrontBytes encode_front(const RecordFront& front, std::span<const std::span<const std::uint8_t>> payload);

/// Nothing if the magic, the type or the length is not that of a record. The CRC is not looked at.
std::optional<RecordFront> decode_front(const FrontBytes& bytes);

/// Does it begin as a record does, as far as it goes?
bool has_magic(std::span<const std::uint8_t> bytes);

bool crc_is_good(const FrontBytes& bytes, std::span<const std::uint8_t> payload);

// Payloads of records that are not the header: docs/journal_format.md. Decoding gives nothing where the
// length or a value is not possible.

inline constexpr std::size_t time_bytes = 8;
std::array<std::uint8_t, time_bytes> encode_time(HostTime time);
std::optional<HostTime> decode_time(std::span<const std::uint8_t> payload);  // its first 8 bytes

std::vector<std::uint8_t> encode_event(const RecordingEvent& event);
std::optional<RecordingEvent> decode_event(std::span<const std::uint8_t> payload);

std::vector<std::uint8_t> encode_leg(const LegRecord& leg);
std::optional<LegRecord> decode_leg(std::span<const std::uint8_t> payload);

/// `count`: of the recording's estimators.
std::vector<std::uint8_t> encode_estimates(const EstimateRow& row, std::size_t count);
std::optional<EstimateRow> decode_estimates(std::span<const std::uint8_t> payload, std::size_t count);

/// Of before format 2: gyro, thermal head and fusion stand in the places of columns_before_format_2().
std::optional<EstimateRow> decode_estimate(std::span<const std::uint8_t> payload);

}  // namespace thermorig::journal

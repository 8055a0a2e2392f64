// SPDX-License-Identifier: MIT
#include "record.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <type_traits>

namespace thermorig::journal {

namespace {

/// Writes `value` at `at`, lowest byte first. Integers of any size.
template <typename Integer>
void put_little_endian(std::uint8_t* at, Integer value) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (std::size_t i = 0; i < sizeof(Integer); ++i) at[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <typename Integer>
Integer get_little_endian(const std::uint8_t* at) {
  std::make_unsigned_t<Integer> bits = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i)
    bits = static_cast<std::make_unsigned_t<Integer>>(
        bits | static_cast<std::make_unsigned_t<Integer>>(static_cast<std::uint64_t>(at[i]) << (8 * i)));
  return static_cast<Integer>(bits);
}

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

constexpr std::uint8_t no_source = 255;
constexpr std::size_t event_front_bytes = 10;
constexpr std::size_t leg_bytes = 35;
constexpr std::size_t message_max_bytes = 64U << 10U;

bool is_source(std::uint8_t source) {
  return source == no_source || source < device_count;
}

bool is_kind(std::uint8_t kind) {
  return kind <= static_cast<std::uint8_t>(last_event_kind);
}

// A row: what every one has, then its estimates. Of before format 2: the same front, then others.
constexpr std::size_t row_bytes = 51;
constexpr std::size_t estimate_bytes = 38;
constexpr std::size_t old_row_bytes = 67;
constexpr std::size_t old_estimators = 3;

float get_float(const std::uint8_t* bytes) {
  return std::bit_cast<float>(get_little_endian<std::uint32_t>(bytes));
}

void put_float(std::uint8_t* bytes, float value) {
  put_little_endian(bytes, std::bit_cast<std::uint32_t>(value));
}

void put_estimate(std::uint8_t* bytes, const RateEstimate& estimate) {
  put_float(bytes, estimate.rate_dps);
  put_float(bytes + 4, estimate.rate_sigma_dps);
  put_little_endian(bytes + 8, std::bit_cast<std::uint64_t>(estimate.angle_deg));
  put_float(bytes + 16, estimate.angle_sigma_deg);
  bytes[20] = static_cast<std::uint8_t>(estimate.state);
  bytes[21] = static_cast<std::uint8_t>(estimate.reason);
  for (std::size_t i = 0; i < most_estimate_values; ++i) put_float(bytes + 22 + 4 * i, estimate.values[i]);
}

/// False for a state or a reason that there is not.
bool get_estimate(const std::uint8_t* bytes, RateEstimate& estimate) {
  if (bytes[20] >= estimate_state_names.size() || bytes[21] >= estimate_reason_names.size()) return false;
  estimate.rate_dps = get_float(bytes);
  estimate.rate_sigma_dps = get_float(bytes + 4);
  estimate.angle_deg = std::bit_cast<double>(get_little_endian<std::uint64_t>(bytes + 8));
  estimate.angle_sigma_deg = get_float(bytes + 16);
  estimate.state = static_cast<EstimateState>(bytes[20]);
  estimate.reason = static_cast<EstimateReason>(bytes[21]);
  for (std::size_t i = 0; i < most_estimate_values; ++i) estimate.values[i] = get_float(bytes + 22 + 4 * i);
  return true;
}

EstimateRow row_of_front(std::span<const std::uint8_t> payload) {
  const auto time = [&](std::size_t at) {
    return host_time_ns(get_little_endian<std::int64_t>(&payload[at]));
  };
  EstimateRow row;
  row.frame_index = get_little_endian<std::uint32_t>(&payload[0]);
  row.time = time(4);
  row.exposure_begin = time(12);
  row.exposure_end = time(20);
  row.arrival = time(28);
  row.rate_commanded_dps = get_float(&payload[36]);
  return row;
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

// ---- payloads of records --------------------------------------------------------------------------------

std::array<std::uint8_t, time_bytes> encode_time(HostTime time) {
  std::array<std::uint8_t, time_bytes> bytes{};
  put_little_endian(bytes.data(), to_ns(time));
  return bytes;
}

std::optional<HostTime> decode_time(std::span<const std::uint8_t> payload) {
  if (payload.size() < time_bytes) return std::nullopt;
  return host_time_ns(get_little_endian<std::int64_t>(payload.data()));
}

std::vector<std::uint8_t> encode_event(const RecordingEvent& event) {
  const std::string message = event.message.substr(0, message_max_bytes);
  std::vector<std::uint8_t> bytes(event_front_bytes + message.size());
  put_little_endian(bytes.data(), to_ns(event.time));
  bytes[8] = static_cast<std::uint8_t>(event.kind);
  bytes[9] = event.source ? static_cast<std::uint8_t>(*event.source) : no_source;
  std::copy(message.begin(), message.end(), bytes.begin() + event_front_bytes);
  return bytes;
}

std::optional<RecordingEvent> decode_event(std::span<const std::uint8_t> payload) {
  if (payload.size() < event_front_bytes || !is_kind(payload[8]) || !is_source(payload[9]))
    return std::nullopt;
  RecordingEvent event;
  event.time = *decode_time(payload);
  event.kind = static_cast<EventKind>(payload[8]);
  if (payload[9] != no_source) event.source = static_cast<Device>(payload[9]);
  event.message.assign(payload.begin() + event_front_bytes, payload.end());
  return event;
}

std::vector<std::uint8_t> encode_leg(const LegRecord& leg) {
  std::vector<std::uint8_t> bytes(leg_bytes);
  put_little_endian(&bytes[0], leg.leg);
  put_little_endian(&bytes[2], static_cast<std::int32_t>(leg.step));
  put_little_endian(&bytes[6], std::bit_cast<std::uint64_t>(leg.rate_dps));
  put_little_endian(&bytes[14], to_ns(leg.begin));
  put_little_endian(&bytes[22], to_ns(leg.end));
  put_little_endian(&bytes[30], static_cast<std::int32_t>(leg.frames));
  bytes[34] = leg.complete ? 1 : 0;
  return bytes;
}

std::optional<LegRecord> decode_leg(std::span<const std::uint8_t> payload) {
  if (payload.size() != leg_bytes || payload[34] > 1) return std::nullopt;
  LegRecord leg;
  leg.leg = get_little_endian<std::uint16_t>(&payload[0]);
  leg.step = get_little_endian<std::int32_t>(&payload[2]);
  leg.rate_dps = std::bit_cast<double>(get_little_endian<std::uint64_t>(&payload[6]));
  leg.begin = host_time_ns(get_little_endian<std::int64_t>(&payload[14]));
  leg.end = host_time_ns(get_little_endian<std::int64_t>(&payload[22]));
  leg.frames = get_little_endian<std::int32_t>(&payload[30]);
  leg.complete = payload[34] == 1;
  return leg;
}

std::vector<std::uint8_t> encode_estimates(const EstimateRow& row, std::size_t count) {
  std::vector<std::uint8_t> bytes(row_bytes + count * estimate_bytes);
  put_little_endian(&bytes[0], row.frame_index);
  put_little_endian(&bytes[4], to_ns(row.time));
  put_little_endian(&bytes[12], to_ns(row.exposure_begin));
  put_little_endian(&bytes[20], to_ns(row.exposure_end));
  put_little_endian(&bytes[28], to_ns(row.arrival));
  put_float(&bytes[36], row.rate_commanded_dps);
  put_little_endian(&bytes[40], row.reason_bits);
  put_little_endian(&bytes[44], row.run);
  put_little_endian(&bytes[48], row.leg);
  bytes[50] = row.counted ? 1 : 0;
  for (std::size_t i = 0; i < count; ++i)
    put_estimate(&bytes[row_bytes + i * estimate_bytes], row.estimates[i]);
  return bytes;
}

std::optional<EstimateRow> decode_estimates(std::span<const std::uint8_t> payload, std::size_t count) {
  if (payload.size() != row_bytes + count * estimate_bytes || payload[50] > 1) return std::nullopt;
  EstimateRow row = row_of_front(payload);
  row.reason_bits = get_little_endian<std::uint32_t>(&payload[40]);
  row.run = get_little_endian<std::uint32_t>(&payload[44]);
  row.leg = get_little_endian<std::uint16_t>(&payload[48]);
  row.counted = payload[50] == 1;
  for (std::size_t i = 0; i < count; ++i)
    if (!get_estimate(&payload[row_bytes + i * estimate_bytes], row.estimates[i])) return std::nullopt;
  return row;
}

std::optional<EstimateRow> decode_estimate(std::span<const std::uint8_t> payload) {
  if (payload.size() != old_row_bytes || payload[66] > 1) return std::nullopt;
  EstimateRow row = row_of_front(payload);
  for (std::size_t i = 0; i < old_estimators; ++i)
    row.estimates[i] = rate_only(get_float(&payload[40 + 4 * i]));
  row.estimates[old_estimators - 1].values[0] = get_float(&payload[52]);  // Kg
  row.reason_bits = get_little_endian<std::uint32_t>(&payload[56]);
  row.run = get_little_endian<std::uint32_t>(&payload[60]);
  row.leg = get_little_endian<std::uint16_t>(&payload[64]);
  row.counted = payload[66] == 1;
  return row;
}

}  // namespace thermorig::journal

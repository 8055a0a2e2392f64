// SPDX-License-Identifier: MIT
#include "payload.h"

#include <algorithm>
#include <bit>

#include "little_endian.h"
#include "record.h"

namespace thermorig::journal {

namespace {

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

}  // namespace

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

std::array<std::uint8_t, estimate_bytes> encode_estimate(const LiveEstimate& row) {
  std::array<std::uint8_t, estimate_bytes> bytes{};
  put_little_endian(&bytes[0], row.frame_index);
  put_little_endian(&bytes[4], to_ns(row.time));
  put_little_endian(&bytes[12], to_ns(row.exposure_begin));
  put_little_endian(&bytes[20], to_ns(row.exposure_end));
  put_little_endian(&bytes[28], to_ns(row.arrival));
  put_little_endian(&bytes[36], std::bit_cast<std::uint32_t>(row.rate_commanded_dps));
  put_little_endian(&bytes[40], std::bit_cast<std::uint32_t>(row.rate_gyro_dps));
  put_little_endian(&bytes[44], std::bit_cast<std::uint32_t>(row.rate_thermal_dps));
  put_little_endian(&bytes[48], std::bit_cast<std::uint32_t>(row.rate_fusion_dps));
  put_little_endian(&bytes[52], std::bit_cast<std::uint32_t>(row.gain));
  put_little_endian(&bytes[56], row.reason_bits);
  put_little_endian(&bytes[60], row.run);
  put_little_endian(&bytes[64], row.leg);
  bytes[66] = row.counted ? 1 : 0;
  return bytes;
}

std::optional<LiveEstimate> decode_estimate(std::span<const std::uint8_t> payload) {
  if (payload.size() != estimate_bytes || payload[66] > 1) return std::nullopt;
  const auto time = [&](std::size_t at) {
    return host_time_ns(get_little_endian<std::int64_t>(&payload[at]));
  };
  const auto number = [&](std::size_t at) {
    return std::bit_cast<float>(get_little_endian<std::uint32_t>(&payload[at]));
  };
  LiveEstimate row;
  row.frame_index = get_little_endian<std::uint32_t>(&payload[0]);
  row.time = time(4);
  row.exposure_begin = time(12);
  row.exposure_end = time(20);
  row.arrival = time(28);
  row.rate_commanded_dps = number(36);
  row.rate_gyro_dps = number(40);
  row.rate_thermal_dps = number(44);
  row.rate_fusion_dps = number(48);
  row.gain = number(52);
  row.reason_bits = get_little_endian<std::uint32_t>(&payload[56]);
  row.run = get_little_endian<std::uint32_t>(&payload[60]);
  row.leg = get_little_endian<std::uint16_t>(&payload[64]);
  row.counted = payload[66] == 1;
  return row;
}

}  // namespace thermorig::journal

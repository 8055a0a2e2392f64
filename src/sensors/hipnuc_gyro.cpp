// SPDX-License-Identifier: MIT
// HiPNUC sensors: HI and CH series. Source: protocols/hipnuc.md.
#include <limits>
#include <set>
#include <string>

#include "foreign_bytes.h"
#include "framed_gyro.h"
#include "thermorig/sensors/wire/checksums.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;

constexpr std::size_t hipnuc_header_bytes = 6, hipnuc_checked_bytes = 4;  // of the header
constexpr std::size_t hipnuc_payload_max = 512;
constexpr std::uint8_t tag_floats = 0x91, tag_counts = 0x81;
constexpr std::size_t floats_bytes = 76, counts_bytes = 104;

std::uint32_t u32_in(Bytes bytes, std::size_t at) {
  return wire::u16_at(bytes, at) | std::uint32_t{wire::u16_at(bytes, at + 2)} << 16U;
}

/// Tag 91: deg/s, ms since it was switched on.
FrameContent read_floats(Bytes payload) {
  GyroReading reading;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reading.rate_dps[axis] = std::bit_cast<float>(u32_in(payload, 24 + 4 * axis));
  reading.temp_c = static_cast<std::int8_t>(payload[3]);
  reading.device_time_us = 1000 * std::int64_t{u32_in(payload, 8)};
  return sample_or_bad_value(reading);
}

/// Tag 81: mrad/s, ms of the GPS week. Without a fix, week and time are 0.
FrameContent read_counts(Bytes payload) {
  using Limits = std::numeric_limits<std::int16_t>;
  GyroReading reading;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int16_t count = wire::i16_at(payload, 12 + 2 * axis);
    reading.counts[axis] = count;
    reading.rate_dps[axis] = static_cast<float>(count * 1e-3 * dps_of_rad_s);
    reading.saturated |= count == Limits::min() || count == Limits::max();
  }
  reading.temp_c = static_cast<std::int8_t>(payload[34]);
  const std::uint32_t week_ms = u32_in(payload, 6);
  if (wire::u16_at(payload, 4) != 0 || week_ms != 0) reading.device_time_us = 1000 * std::int64_t{week_ms};
  return sample_or_bad_value(reading);
}

class HipnucFraming {
 public:
  using Content = FrameContent;
  static constexpr std::uint8_t sync = 0x5A;
  static constexpr std::size_t longest = hipnuc_header_bytes + hipnuc_payload_max;

  static std::optional<std::size_t> size(Bytes rest) {
    if (rest.size() > 1 && rest[1] != 0xA5) return std::nullopt;
    if (rest.size() < hipnuc_header_bytes) return 0;
    const std::size_t payload = wire::u16_at(rest, 2);
    if (payload == 0 || payload > hipnuc_payload_max) return std::nullopt;
    return hipnuc_header_bytes + payload;
  }

  static bool is_good(Bytes frame) {
    const std::uint16_t header = wire::crc16_xmodem(frame.first(hipnuc_checked_bytes));
    return wire::crc16_xmodem(frame.subspan(hipnuc_header_bytes), header) ==
           wire::u16_at(frame, hipnuc_checked_bytes);
  }
  static bool is_proof(Bytes) { return true; }

  /// A packet that goes on behind its tag's size may hold another sensor's rates: it is not chosen from.
  FrameContent read(Bytes frame) {
    const Bytes payload = frame.subspan(hipnuc_header_bytes);
    const std::uint8_t tag = payload[0];
    if (tag != tag_floats && tag != tag_counts) {
      other_tags.insert(tag);
      return {};
    }
    if (payload.size() != (tag == tag_floats ? floats_bytes : counts_bytes))
      return FrameContent::bad(FrameContent::Kind::bad_length);
    return tag == tag_floats ? read_floats(payload) : read_counts(payload);
  }
  void restart() {}

  std::set<std::uint8_t> other_tags;  // that were seen
};

constexpr std::array<UsualBaud, 2> hipnuc_bauds{{{115200, 0.15}, {921600, 0.04}}};

ClockProperties hipnuc_clock(const GyroProfile&) {
  return {.tick_s = 1e-3, .wrap_ticks = std::uint64_t{1} << 32U};
}

std::uint64_t hipnuc_message_bytes(const GyroProfile&) {
  return hipnuc_header_bytes + floats_bytes;  // what it sends unless it is told otherwise
}

GyroScanner hipnuc_scanner(const GyroProfile&, StreamStart) {
  return GyroScanner(FramedScanner(HipnucFraming()));
}

std::optional<Evidence> recognise_hipnuc(Bytes bytes, double) {
  const auto scanner = scanned(HipnucFraming(), bytes);
  std::string tags;
  for (const std::uint8_t tag : scanner.framing().other_tags)
    tags += fmt::format("{}{:02X}", tags.empty() ? " (tag " : ", ", tag);
  if (!tags.empty()) tags += ")";
  return framed_evidence(scanner.counters(), "HiPNUC packets", tags,
                         "let it send packet 91, or 81, with the maker's tool");
}

}  // namespace

FramedProtocol hipnuc_frames() {
  return framed_protocol<HipnucFraming>("HiPNUC packets (5A A5)");
}

GyroProtocol hipnuc_gyro() {
  return {.name = "hipnuc",
          .sends = "HiPNUC packets (91, 81)",
          .settings = {},
          .bauds = hipnuc_bauds,
          .usual_rate_hz = 100.0,
          .clock = hipnuc_clock,
          .message_bytes = hipnuc_message_bytes,
          .scanner = hipnuc_scanner,
          .recognise = recognise_hipnuc};
}

}  // namespace thermorig::sensors

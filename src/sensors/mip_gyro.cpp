// SPDX-License-Identifier: MIT
// MicroStrain sensors: MIP. Source: protocols/mip.md.
#include <limits>

#include "foreign_bytes.h"
#include "framed_gyro.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;

constexpr std::size_t mip_header_bytes = 4, mip_sum_bytes = 2;
constexpr std::uint8_t sensor_data = 0x80;  // a descriptor set
constexpr std::uint8_t scaled_gyro = 0x05, reference_time = 0xD5;
constexpr std::size_t scaled_gyro_bytes = 12, reference_time_bytes = 8;

/// Fletcher's sum: of the bytes, and of the sums.
std::uint16_t fletcher16(Bytes bytes) {
  std::uint8_t first = 0, second = 0;
  for (const std::uint8_t byte : bytes) {
    first = static_cast<std::uint8_t>(first + byte);
    second = static_cast<std::uint8_t>(second + first);
  }
  return static_cast<std::uint16_t>(first << 8 | second);
}

class MipFraming {
 public:
  using Content = FrameContent;
  static constexpr std::uint8_t sync = 0x75;
  static constexpr std::size_t longest = mip_header_bytes + 255 + mip_sum_bytes;

  static std::optional<std::size_t> size(Bytes rest) {
    if (rest.size() > 1 && rest[1] != 0x65) return std::nullopt;
    if (rest.size() < mip_header_bytes) return 0;
    return mip_header_bytes + rest[3] + mip_sum_bytes;
  }

  static bool is_good(Bytes frame) {
    const std::size_t checked = frame.size() - mip_sum_bytes;
    return fletcher16(frame.first(checked)) == big_endian(frame.subspan(checked));
  }
  static bool is_proof(Bytes) { return true; }

  FrameContent read(Bytes frame) {
    using Kind = FrameContent::Kind;
    if (frame[2] != sensor_data) return {};
    GyroReading reading;
    std::size_t rates = 0;
    Bytes fields = frame.subspan(mip_header_bytes, frame[3]);
    while (!fields.empty()) {
      const std::size_t size = fields[0];  // with itself and the descriptor
      if (size < 2 || size > fields.size()) return FrameContent::bad(Kind::bad_length);
      const Bytes data = fields.subspan(2, size - 2);
      if (fields[1] == scaled_gyro) {
        if (data.size() != scaled_gyro_bytes) return FrameContent::bad(Kind::bad_length);
        ++rates;
        for (std::size_t axis = 0; axis < 3; ++axis)
          reading.rate_dps[axis] =
              static_cast<float>(big_endian_float(data.subspan(4 * axis)) * dps_of_rad_s);
      }
      if (fields[1] == reference_time && data.size() == reference_time_bytes)
        reading.device_time_us = static_cast<std::int64_t>(big_endian(data) / 1000);
      fields = fields.subspan(size);
    }
    if (rates == 0) return {};
    if (rates > 1) return FrameContent::bad(Kind::bad_value);
    return sample_or_bad_value(reading);
  }
  void restart() {}
};

constexpr std::array<UsualBaud, 2> mip_bauds{{{115200, 0.15}, {921600, 0.04}}};

ClockProperties mip_clock(const GyroProfile&) {
  return {.tick_s = 1e-6};  // nanoseconds, of which whole microseconds are kept
}

/// With acceleration and magnetic field beside the rates.
std::uint64_t mip_message_bytes(const GyroProfile&) {
  return 80;
}

GyroScanner mip_scanner(const GyroProfile&, StreamStart) {
  return GyroScanner(FramedScanner(MipFraming()));
}

std::optional<Evidence> recognise_mip(Bytes bytes, double) {
  return framed_evidence(scanned(MipFraming(), bytes).counters(), "MicroStrain packets (MIP)", "",
                         "let it stream set 80 with field 05 (scaled gyro) and D5 (reference time): "
                         "SensorConnect");
}

}  // namespace

FramedProtocol mip_frames() {
  return framed_protocol<MipFraming>("MicroStrain packets (75 65)");
}

GyroProtocol mip_gyro() {
  return {.name = "mip",
          .sends = "MicroStrain packets (MIP)",
          .settings = {},
          .bauds = mip_bauds,
          .usual_rate_hz = 100.0,
          .clock = mip_clock,
          .message_bytes = mip_message_bytes,
          .scanner = mip_scanner,
          .recognise = recognise_mip};
}

}  // namespace thermorig::sensors

// SPDX-License-Identifier: MIT
// Xsens (Movella) MTi sensors: MTData2. Source: protocols/xsens.md.
#include "foreign_bytes.h"
#include "framed_gyro.h"
#include "thermorig/sensors/wire/checksums.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;

constexpr std::uint8_t mtdata2 = 0x36;
constexpr std::uint8_t is_extended = 0xFF;  // a length: its two bytes follow
constexpr std::size_t xsens_data_max = 2048;
constexpr std::size_t xsens_header_bytes = 4, xsens_extended_bytes = 6;
// What an item holds; its last four bits are the format of its numbers.
constexpr std::uint16_t rate_of_turn = 0x8020, packet_counter = 0x1020, sample_time = 0x1060;
constexpr std::uint16_t temperature = 0x0810, status_word = 0xE020;
constexpr std::uint32_t gyro_clipped = 0x3800;  // x, y, z
constexpr double sample_time_s = 1e-4;

std::size_t header_bytes(Bytes frame) {
  return frame[3] == is_extended ? xsens_extended_bytes : xsens_header_bytes;
}

Bytes items_of(Bytes frame) {
  const std::size_t header = header_bytes(frame);
  return frame.subspan(header, frame.size() - header - 1);
}

/// Calls `use(identifier, data)` for each item; false if they do not fill the message.
template <typename Use>
bool for_each_item(Bytes items, Use use) {
  while (!items.empty()) {
    if (items.size() < 3 || items.size() < 3U + items[2]) return false;
    use(static_cast<std::uint16_t>(big_endian(items.first(2))), items.subspan(3, items[2]));
    items = items.subspan(3U + items[2]);
  }
  return true;
}

/// Three numbers in one of the formats: float, fixed point of 12.20 and of 16.32 bits, double.
std::optional<std::array<double, 3>> three_numbers(unsigned format, Bytes data) {
  constexpr std::array<std::size_t, 4> sizes{4, 4, 6, 8};
  if (data.size() != 3 * sizes[format]) return std::nullopt;
  std::array<double, 3> numbers{};
  for (double& number : numbers) {
    const Bytes bytes = data.first(sizes[format]);
    data = data.subspan(sizes[format]);
    const std::uint64_t all = big_endian(bytes);
    if (format == 0) number = std::bit_cast<float>(static_cast<std::uint32_t>(all));
    if (format == 1) number = std::ldexp(static_cast<std::int32_t>(static_cast<std::uint32_t>(all)), -20);
    if (format == 2)  // the fraction stands in front
      number = static_cast<std::int16_t>(static_cast<std::uint16_t>(big_endian(bytes.subspan(4)))) +
               std::ldexp(static_cast<double>(big_endian(bytes.first(4))), -32);
    if (format == 3) number = std::bit_cast<double>(all);
  }
  return numbers;
}

class XsensFraming {
 public:
  using Content = FrameContent;
  static constexpr std::uint8_t sync = 0xFA;
  static constexpr std::size_t longest = xsens_extended_bytes + xsens_data_max + 1;

  explicit XsensFraming(double rate_hz) : rate_hz_(rate_hz) {}

  static std::optional<std::size_t> size(Bytes rest) {
    if (rest.size() > 1 && rest[1] != 0xFF) return std::nullopt;
    if (rest.size() < xsens_header_bytes || rest.size() < header_bytes(rest)) return 0;
    const std::size_t header = header_bytes(rest);
    const auto data = rest[3] == is_extended ? static_cast<std::size_t>(big_endian(rest.subspan(4, 2)))
                                             : std::size_t{rest[3]};
    return data <= xsens_data_max ? std::optional(header + data + 1) : std::nullopt;
  }

  static bool is_good(Bytes frame) { return wire::byte_sum8(frame.subspan(1)) == 0; }

  /// The sum is one byte: items that fill the message make up for it.
  static bool is_proof(Bytes frame) {
    const Bytes items = items_of(frame);
    return frame[2] == mtdata2 && !items.empty() && for_each_item(items, [](std::uint16_t, Bytes) {});
  }

  FrameContent read(Bytes frame) {
    using Kind = FrameContent::Kind;
    if (frame[2] != mtdata2) return {};
    GyroReading reading;
    std::optional<std::int64_t> by_time_us, by_counter_us;
    std::size_t rates = 0;
    bool is_odd = false;
    const bool is_whole = for_each_item(items_of(frame), [&](std::uint16_t identifier, Bytes data) {
      const auto what = static_cast<std::uint16_t>(identifier & 0xFFF0U);
      const unsigned format = identifier & 3U;
      if (what == rate_of_turn) {
        const auto numbers = three_numbers(format, data);
        is_odd |= !numbers || ++rates > 1;
        for (std::size_t axis = 0; numbers && axis < 3; ++axis)
          reading.rate_dps[axis] = static_cast<float>((*numbers)[axis] * dps_of_rad_s);
      } else if (what == sample_time && data.size() == 4) {
        by_time_us = std::llround(sample_time_s * 1e6) * static_cast<std::int64_t>(big_endian(data));
      } else if (what == packet_counter && data.size() == 2) {
        by_counter_us = counted_us(static_cast<std::uint16_t>(big_endian(data)));
      } else if (what == temperature && format == 0 && data.size() == 4) {
        if (const float temp_c = big_endian_float(data); std::isfinite(temp_c)) reading.temp_c = temp_c;
      } else if (what == status_word && data.size() == 4) {
        reading.saturated = (big_endian(data) & gyro_clipped) != 0;
      }
    });
    if (!is_whole) return FrameContent::bad(Kind::bad_length);
    if (is_odd) return FrameContent::bad(Kind::bad_value);
    if (rates == 0) return {};
    reading.device_time_us = by_time_us ? by_time_us : by_counter_us;
    return sample_or_bad_value(reading);
  }

  void restart() { counter_.reset(); }

 private:
  /// The counter has 16 bits. With a rate that is not the profile's this clock runs too fast or too slow,
  /// which the check against the host's clock finds.
  std::int64_t counted_us(std::uint16_t counter) {
    count_ += static_cast<std::uint16_t>(counter - counter_.value_or(counter));
    counter_ = counter;
    return std::llround(1e6 * static_cast<double>(count_) / rate_hz_);
  }

  double rate_hz_;
  std::optional<std::uint16_t> counter_;
  std::uint64_t count_ = 0;
};

constexpr std::array<UsualBaud, 3> xsens_bauds{{{115200, 0.15}, {921600, 0.04}, {460800, 0.04}}};

/// SampleTimeFine, which begins again after 119 hours.
ClockProperties xsens_clock(const GyroProfile&) {
  return {.tick_s = sample_time_s, .wrap_ticks = std::uint64_t{1} << 32U};
}

/// With orientation, acceleration and magnetic field, which its owner may have it send, it is about that.
std::uint64_t xsens_message_bytes(const GyroProfile&) {
  return 100;
}

GyroScanner xsens_scanner(const GyroProfile& profile, StreamStart) {
  return GyroScanner(FramedScanner(XsensFraming(profile.output_rate_hz)));
}

std::optional<Evidence> recognise_xsens(Bytes bytes, double) {
  return framed_evidence(scanned(XsensFraming(100.0), bytes).counters(), "Xsens messages", "",
                         "let it send MTData2 with RateOfTurn (8020) and SampleTimeFine (1060): MT Manager, "
                         "output configuration");
}

}  // namespace

FramedProtocol xsens_frames() {
  return framed_protocol<XsensFraming>("Xsens messages (FA FF)");
}

GyroProtocol xsens_gyro() {
  return {.name = "xsens",
          .sends = "Xsens messages (MTData2)",
          .settings = {},
          .bauds = xsens_bauds,
          .usual_rate_hz = 100.0,
          .clock = xsens_clock,
          .message_bytes = xsens_message_bytes,
          .scanner = xsens_scanner,
          .recognise = recognise_xsens};
}

}  // namespace thermorig::sensors

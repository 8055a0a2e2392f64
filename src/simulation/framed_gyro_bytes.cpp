// SPDX-License-Identifier: MIT
// VectorNav, Xsens, HiPNUC and MicroStrain gyros as they send. Written from protocols/*.md once more: nothing
// is shared with what reads them.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "gyro.h"

namespace thermorig::simulation {
namespace {

constexpr double rad_per_deg = std::numbers::pi / 180.0;
constexpr double gravity_ms2 = 9.81;

enum class Order : std::uint8_t { little, big };

/// Appends numbers to a message.
class Writer {
 public:
  Writer(std::vector<std::uint8_t> begin, Order order) : bytes_(std::move(begin)), order_(order) {}

  void whole(std::uint64_t number, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      bytes_.push_back(
          static_cast<std::uint8_t>(number >> (8 * (order_ == Order::little ? i : size - 1 - i))));
  }
  void real(double number) { whole(std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4); }
  void rates(const SimulatedGyroSample& sample, double unit) {
    for (const double rate_dps : sample.rate_dps) real(rate_dps * unit);
  }
  std::vector<std::uint8_t>& bytes() { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
  Order order_;
};

std::vector<std::uint8_t> vectornav_message(const std::string& text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  const std::string message = fmt::format("${}*{:02X}\r\n", text, sum);
  return {message.begin(), message.end()};
}

/// The uncompensated rates, or those of the filter: the simulated one has found no bias.
std::vector<std::uint8_t> vectornav_rates(const SimulatedGyroSample& sample, bool filtered) {
  const auto rate = [&](std::size_t axis) { return sample.rate_dps[axis] * rad_per_deg; };
  const std::string field_and_gravity = fmt::format(
      "{:+08.4f},{:+08.4f},{:+08.4f},{:+07.3f},{:+07.3f},{:+07.3f}", 0.2, -0.1, 0.45, 0.0, 0.0, -gravity_ms2);
  const std::string rates = fmt::format("{:+010.6f},{:+010.6f},{:+010.6f}", rate(0), rate(1), rate(2));
  if (filtered) return vectornav_message("VNYMR,+000.000,+00.000,+00.000," + field_and_gravity + "," + rates);
  return vectornav_message(
      fmt::format("VNIMU,{},{},{:+05.1f},+101.325", field_and_gravity, rates, sample.temp_c));
}

std::vector<std::uint8_t> vectornav_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  return vectornav_rates(sample, profile.setting("filtered") != 0.0);
}

/// What is written into its register is answered as it came.
Heard vectornav_hear(std::span<const std::uint8_t> bytes, const GyroProfile& profile, GyroStart, double) {
  constexpr std::string_view asks_imu = "$VNWRG,06,19*54\r\n", asks_filtered = "$VNWRG,06,14*59\r\n";
  const std::string_view heard(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (heard != asks_imu && heard != asks_filtered) return {};
  const bool is_own = (heard == asks_filtered) == (profile.setting("filtered") != 0.0);
  return {.asks_for_stream = is_own, .answer = {bytes.begin(), bytes.end()}};
}

/// Until it is asked it sends what it came with.
std::vector<std::uint8_t> vectornav_idle_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  return vectornav_rates(sample, true);
}

std::vector<std::uint8_t> xsens_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  Writer message({0xFA, 0xFF, 0x36, 34}, Order::big);
  message.whole(0x102002, 3);  // counter
  message.whole(sample.index, 2);
  message.whole(0x106004, 3);  // 0.1 ms
  message.whole(static_cast<std::uint64_t>(sample.device_time_us / 100), 4);
  message.whole(0x80200C, 3);  // rad/s
  message.rates(sample, rad_per_deg);
  message.whole(0x081004, 3);  // degC
  message.real(sample.temp_c);
  unsigned sum = 0;
  for (const std::uint8_t byte : message.bytes()) sum += byte;
  message.whole(0x100U - ((sum - 0xFAU) & 0xFFU), 1);
  return message.bytes();
}

/// CRC-16 of polynomial 1021, a byte at a time.
std::uint16_t xmodem(std::uint16_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    unsigned mixed = (crc >> 8U) ^ byte;
    mixed ^= mixed >> 4U;
    crc = static_cast<std::uint16_t>((crc << 8U) ^ (mixed << 12U) ^ (mixed << 5U) ^ mixed);
  }
  return crc;
}

std::vector<std::uint8_t> hipnuc_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  Writer packet({0x5A, 0xA5, 76, 0, 0, 0, 0x91, 0, 0}, Order::little);
  packet.whole(static_cast<std::uint8_t>(std::lround(sample.temp_c)), 1);
  packet.real(101'325.0);
  packet.whole(static_cast<std::uint64_t>(sample.device_time_us / 1000), 4);
  for (const double g : {0.0, 0.0, 1.0}) packet.real(g);
  packet.rates(sample, 1.0);
  for (const double other : {20.0, -10.0, 45.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0}) packet.real(other);
  std::vector<std::uint8_t>& bytes = packet.bytes();
  const std::span all(bytes);
  const std::uint16_t crc = xmodem(xmodem(0, all.first(4)), all.subspan(6));
  bytes[4] = static_cast<std::uint8_t>(crc & 0xFFU);
  bytes[5] = static_cast<std::uint8_t>(crc >> 8U);
  return bytes;
}

std::vector<std::uint8_t> mip_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  Writer packet({0x75, 0x65, 0x80, 24, 10, 0xD5}, Order::big);
  packet.whole(static_cast<std::uint64_t>(sample.device_time_us) * 1000, 8);
  packet.whole(0x0E05, 2);
  packet.rates(sample, rad_per_deg);
  unsigned first = 0, second = 0;
  for (const std::uint8_t byte : packet.bytes()) second += first += byte;
  packet.whole((first & 0xFFU) << 8U | (second & 0xFFU), 2);
  return packet.bytes();
}

}  // namespace

GyroEncoder vectornav_encoder() {
  return {"vectornav", vectornav_bytes, vectornav_hear, vectornav_idle_bytes};
}
GyroEncoder xsens_encoder() {
  return {"xsens", xsens_bytes};
}
GyroEncoder hipnuc_encoder() {
  return {"hipnuc", hipnuc_bytes};
}
GyroEncoder mip_encoder() {
  return {"mip", mip_bytes};
}

}  // namespace thermorig::simulation

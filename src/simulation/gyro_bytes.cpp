// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>

#include "mavlink.h"
#include "thermorig/core/error.h"
#include "thermorig/simulation/gyro.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

std::vector<std::uint8_t> witmotion_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  std::array<std::int16_t, 3> counts{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<std::int16_t>(
        std::clamp(std::round(sample.rate_dps[axis] / wire::witmotion_dps_per_count), -32768.0, 32767.0));
  const auto packet = wire::witmotion_gyro_packet(counts, static_cast<float>(sample.temp_c));
  return {packet.begin(), packet.end()};
}

/// Boards that send counts (a scale far below 1) print whole numbers.
std::string number_text(double rate_dps, double scale_dps) {
  const double value = rate_dps / scale_dps;
  return scale_dps < 0.5 ? fmt::format("{:.0f}", value) : fmt::format("{:.4f}", value);
}

std::vector<std::uint8_t> text_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const TextColumns& columns = profile.text;
  const int last = std::max(*std::max_element(columns.rate.begin(), columns.rate.end()), columns.time);
  std::vector<std::string> fields(static_cast<std::size_t>(last + 1), "0");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (columns.rate[axis] >= 0)
      fields[static_cast<std::size_t>(columns.rate[axis])] =
          number_text(sample.rate_dps[axis], columns.scale_dps);
  if (columns.time >= 0)
    fields[static_cast<std::size_t>(columns.time)] =
        fmt::format("{:.0f}", static_cast<double>(sample.device_time_us) * 1e-6 / columns.time_unit_s);
  const std::string line = fmt::format("{}{}\r\n", columns.prefix, fmt::join(fields, ","));
  return {line.begin(), line.end()};
}

/// CRC-16/MCRF4XX as MAVLink's documents compute it, a byte at a time.
std::uint16_t x25(std::span<const std::uint8_t> bytes, std::uint8_t crc_extra) {
  std::uint16_t crc = 0xFFFF;
  const auto add = [&](std::uint8_t byte) {
    unsigned mixed = byte ^ (crc & 0xFFU);
    mixed = (mixed ^ (mixed << 4)) & 0xFFU;
    crc = static_cast<std::uint16_t>((crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
  };
  for (const std::uint8_t byte : bytes) add(byte);
  add(crc_extra);
  return crc;
}

template <typename Number>
void put_little_endian(std::vector<std::uint8_t>& bytes, std::size_t at, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
}

/// A packet of version 2, the zeros at its payload's end left out.
std::vector<std::uint8_t> mavlink_packet(const mavlink::Message& message, std::uint64_t number,
                                         const GyroProfile& profile, std::vector<std::uint8_t> payload) {
  while (payload.size() > 1 && payload.back() == 0) payload.pop_back();
  const auto own = [&](const char* name) {
    return static_cast<std::uint8_t>(std::max(1.0, profile.setting(name)));
  };
  const std::array<std::uint8_t, mavlink::header_v2_bytes> header{mavlink::sync_v2,
                                                                  static_cast<std::uint8_t>(payload.size()),
                                                                  0,
                                                                  0,
                                                                  static_cast<std::uint8_t>(number),
                                                                  own("system"),
                                                                  own("component"),
                                                                  static_cast<std::uint8_t>(message.id),
                                                                  0,
                                                                  0};
  std::vector<std::uint8_t> bytes(header.size() + payload.size() + mavlink::checksum_bytes);
  const auto behind =
      std::copy(payload.begin(), payload.end(), std::copy(header.begin(), header.end(), bytes.begin()));
  const auto checked = std::span(bytes.begin() + 1, behind);
  put_little_endian(bytes, header.size() + payload.size(), x25(checked, message.crc_extra));
  return bytes;
}

void put_counts(std::vector<std::uint8_t>& payload, std::size_t at, const std::array<double, 3>& rate_dps,
                double dps_per_count) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    put_little_endian(
        payload, at + 2 * axis,
        static_cast<std::int16_t>(std::clamp(std::round(rate_dps[axis] / dps_per_count), -32768.0, 32767.0)));
}

std::int16_t hundredths(double temp_c) {
  return static_cast<std::int16_t>(std::lround(temp_c / mavlink::kelvin_per_count));
}

constexpr double dps_per_mrad_s = 0.18 / std::numbers::pi;

std::vector<std::uint8_t> scaled_imu_payload(const SimulatedGyroSample& sample) {
  std::vector<std::uint8_t> payload(mavlink::scaled_imu.payload);
  put_little_endian(payload, mavlink::scaled_imu_time_ms,
                    static_cast<std::uint32_t>(sample.device_time_us / 1000));
  put_counts(payload, mavlink::scaled_imu_gyro, sample.rate_dps, dps_per_mrad_s);
  put_little_endian(payload, mavlink::scaled_imu_temperature, hundredths(sample.temp_c));
  return payload;
}

std::vector<std::uint8_t> raw_imu_payload(const SimulatedGyroSample& sample, double scale_dps) {
  std::vector<std::uint8_t> payload(mavlink::raw_imu.payload);
  put_little_endian(payload, mavlink::raw_imu_time_us, sample.device_time_us);
  put_counts(payload, mavlink::raw_imu_gyro, sample.rate_dps, scale_dps);
  put_little_endian(payload, mavlink::raw_imu_temperature, hundredths(sample.temp_c));
  return payload;
}

std::vector<std::uint8_t> highres_imu_payload(const SimulatedGyroSample& sample) {
  std::vector<std::uint8_t> payload(mavlink::highres_imu.payload);
  const auto put_float = [&](std::size_t at, double value) {
    put_little_endian(payload, at, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  };
  put_little_endian(payload, mavlink::highres_imu_time_us, sample.device_time_us);
  for (std::size_t axis = 0; axis < 3; ++axis)
    put_float(mavlink::highres_imu_gyro + 4 * axis, 1e-3 * sample.rate_dps[axis] / dps_per_mrad_s);
  put_float(mavlink::highres_imu_temperature, sample.temp_c);
  put_little_endian(payload, mavlink::highres_imu_updated,
                    std::uint16_t{mavlink::updated_gyro | mavlink::updated_temperature});
  return payload;
}

/// As the message that the profile names; without a name as RAW_IMU where its scale is stated, else as
/// SCALED_IMU.
std::vector<std::uint8_t> imu_packet(const SimulatedGyroSample& sample, std::uint64_t number,
                                     const GyroProfile& profile) {
  const auto message = static_cast<std::uint32_t>(profile.setting("message"));
  const double raw_scale_dps = profile.setting("raw_scale_dps");
  if (message == mavlink::highres_imu.id)
    return mavlink_packet(mavlink::highres_imu, number, profile, highres_imu_payload(sample));
  if (raw_scale_dps > 0.0 && (message == 0 || message == mavlink::raw_imu.id))
    return mavlink_packet(mavlink::raw_imu, number, profile, raw_imu_payload(sample, raw_scale_dps));
  return mavlink_packet(mavlink::scaled_imu, number, profile, scaled_imu_payload(sample));
}

/// Once a second a heartbeat comes behind the sample. Packets of both kinds are numbered together.
std::vector<std::uint8_t> mavlink_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const auto samples_a_second = static_cast<std::uint64_t>(std::max(1.0, std::round(profile.output_rate_hz)));
  const std::uint64_t heartbeats = (sample.index + samples_a_second - 1) / samples_a_second;
  const std::uint64_t number = sample.index + heartbeats;
  std::vector<std::uint8_t> bytes = imu_packet(sample, number, profile);
  if (sample.index % samples_a_second != 0) return bytes;
  const std::vector<std::uint8_t> quadrotor{0, 0, 0, 0, 2, 3, 0, 4, 3};  // ArduPilot's, active, version 3
  const auto heartbeat = mavlink_packet(mavlink::heartbeat, number + 1, profile, quadrotor);
  bytes.insert(bytes.end(), heartbeat.begin(), heartbeat.end());
  return bytes;
}

constexpr std::array encoders{GyroEncoder{"witmotion", witmotion_bytes}, GyroEncoder{"text", text_bytes},
                              GyroEncoder{"mavlink", mavlink_bytes}};

}  // namespace

std::span<const GyroEncoder> gyro_encoders() {
  return encoders;
}

std::vector<std::uint8_t> gyro_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const auto found = std::find_if(encoders.begin(), encoders.end(), [&](const GyroEncoder& encoder) {
    return encoder.name == profile.protocol;
  });
  if (found == encoders.end())
    throw Error(ExitCode::bad_usage, "the simulated gyro does not speak \"" + profile.protocol + "\"",
                "the gyro's protocol", "one that `thermorig decode --help` lists");
  return found->bytes(sample, profile);
}

}  // namespace thermorig::simulation

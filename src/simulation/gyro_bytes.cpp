// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>

#include "encoder_table.h"
#include "gyro.h"
#include "mavlink.h"
#include "thermorig/sensors/wire/device_bytes.h"

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

/// The steps that such devices have, written once more from their description: nothing is shared with the
/// program that asks.
constexpr std::array<double, 7> witmotion_steps_hz{256.0, 188.0, 98.0, 42.0, 20.0, 10.0, 5.0};

/// Read register 1F. One without a low-pass, or whose low-pass is none of the steps, says nothing, as older
/// devices do.
Heard witmotion_hear(std::span<const std::uint8_t> bytes, const GyroProfile&, GyroStart,
                     double bandwidth_hz) {
  constexpr std::array<std::uint8_t, 5> question{0xFF, 0xAA, 0x27, 0x1F, 0x00};
  constexpr double same = 0.05;
  if (!std::equal(question.begin(), question.end(), bytes.begin(), bytes.end())) return {};
  if (bandwidth_hz >= witmotion_steps_hz.front()) return {};
  for (std::size_t step = 0; step < witmotion_steps_hz.size(); ++step) {
    if (std::abs(bandwidth_hz / witmotion_steps_hz[step] - 1.0) > same) continue;
    std::vector<std::uint8_t> answer{0x55, 0x5F, static_cast<std::uint8_t>(step), 0, 0, 0, 0, 0, 0, 0};
    answer.push_back(static_cast<std::uint8_t>(0x55 + 0x5F + step));
    return {.asks_for_stream = false, .answer = answer};
  }
  return {};
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

std::uint64_t samples_a_second(const GyroProfile& profile) {
  return static_cast<std::uint64_t>(std::max(1.0, std::round(profile.output_rate_hz)));
}

std::vector<std::uint8_t> heartbeat_packet(std::uint64_t number, const GyroProfile& profile) {
  const std::vector<std::uint8_t> quadrotor{0, 0, 0, 0, 2, 3, 0, 4, 3};  // ArduPilot's, active, version 3
  return mavlink_packet(mavlink::heartbeat, number, profile, quadrotor);
}

/// Once a second a heartbeat comes behind the sample. Packets of both kinds are numbered together.
std::vector<std::uint8_t> mavlink_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const std::uint64_t second = samples_a_second(profile);
  const std::uint64_t number = sample.index + (sample.index + second - 1) / second;
  std::vector<std::uint8_t> bytes = imu_packet(sample, number, profile);
  if (sample.index % second != 0) return bytes;
  const auto heartbeat = heartbeat_packet(number + 1, profile);
  bytes.insert(bytes.end(), heartbeat.begin(), heartbeat.end());
  return bytes;
}

/// A controller that nobody asked for anything sends its heartbeat.
std::vector<std::uint8_t> mavlink_idle_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const std::uint64_t second = samples_a_second(profile);
  if (sample.index % second != 0) return {};
  return heartbeat_packet(sample.index / second, profile);
}

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{bytes[at + i]} << (8 * i);
  return value;
}

/// The payload of a packet of version 2 or 1 at the front of the bytes, as long as the message's own; empty
/// if it is another message or its check sum is wrong. `bytes` then are those behind it.
std::vector<std::uint8_t> take_payload(const mavlink::Message& message,
                                       std::span<const std::uint8_t>& bytes) {
  if (bytes.empty()) return {};
  const bool is_v2 = bytes[0] == mavlink::sync_v2;
  const std::size_t header = is_v2 ? mavlink::header_v2_bytes : mavlink::header_v1_bytes;
  const std::size_t id_at = is_v2 ? 7 : 5;
  if (bytes.size() < header || (!is_v2 && bytes[0] != mavlink::sync_v1) || bytes[id_at] != message.id)
    return {};
  const std::size_t end = header + bytes[mavlink::length_offset];
  if (bytes.size() < end + mavlink::checksum_bytes) return {};
  const std::uint16_t sum = x25(bytes.subspan(1, end - 1), message.crc_extra);
  if (bytes[end] != (sum & 0xFFU) || bytes[end + 1] != sum >> 8) return {};
  std::vector<std::uint8_t> payload(bytes.begin() + static_cast<std::ptrdiff_t>(header),
                                    bytes.begin() + static_cast<std::ptrdiff_t>(end));
  payload.resize(message.payload);
  bytes = bytes.subspan(end + mavlink::checksum_bytes);
  return payload;
}

bool is_for_us(std::uint8_t addressee, double own) {
  return addressee == 0 || addressee == static_cast<std::uint8_t>(std::max(1.0, own));
}

/// Which message imu_packet() sends.
std::uint32_t imu_message(const GyroProfile& profile) {
  const auto named = static_cast<std::uint32_t>(profile.setting("message"));
  const bool is_raw = profile.setting("raw_scale_dps") > 0.0;
  if (named != 0) return named;
  return is_raw ? mavlink::raw_imu.id : mavlink::scaled_imu.id;
}

/// Whether it commands the message that this controller sends, at the rate that it has.
bool commands_samples(std::span<const std::uint8_t> payload, const GyroProfile& profile) {
  const auto parameter = [&](std::size_t index) {
    return std::bit_cast<float>(u32_at(payload, mavlink::command_long_parameters + 4 * index));
  };
  const bool is_own = is_for_us(payload[mavlink::command_long_system], profile.setting("system")) &&
                      is_for_us(payload[mavlink::command_long_component], profile.setting("component"));
  const unsigned command =
      payload[mavlink::command_long_command] | unsigned{payload[mavlink::command_long_command + 1]} << 8;
  return is_own && command == mavlink::set_message_interval &&
         parameter(0) == static_cast<float>(imu_message(profile)) &&
         std::abs(parameter(1) * profile.output_rate_hz - 1e6) < 1e3;
}

bool requests_samples(std::span<const std::uint8_t> payload, const GyroProfile& profile) {
  const unsigned rate_hz =
      payload[mavlink::data_stream_rate_hz] | unsigned{payload[mavlink::data_stream_rate_hz + 1]} << 8;
  return is_for_us(payload[mavlink::data_stream_system], profile.setting("system")) &&
         is_for_us(payload[mavlink::data_stream_component], profile.setting("component")) &&
         payload[mavlink::data_stream_id] == mavlink::raw_sensors_stream &&
         payload[mavlink::data_stream_start] == 1 && rate_hz == std::lround(profile.output_rate_hz);
}

/// Commands are acknowledged; what they are for, a controller of old does not know.
Heard mavlink_hear(std::span<const std::uint8_t> bytes, const GyroProfile& profile, GyroStart start, double) {
  Heard heard;
  const bool is_old = start == GyroStart::when_asked_of_old;
  if (const auto command = take_payload(mavlink::command_long, bytes); !command.empty()) {
    heard.asks_for_stream = !is_old && commands_samples(command, profile);
    std::vector<std::uint8_t> answer(mavlink::command_ack.payload_min);
    put_little_endian(answer, mavlink::command_ack_command, mavlink::set_message_interval);
    answer[mavlink::command_ack_result] =
        heard.asks_for_stream ? mavlink::result_accepted : mavlink::result_unsupported;
    heard.answer = mavlink_packet(mavlink::command_ack, 0, profile, answer);
  }
  if (const auto request = take_payload(mavlink::request_data_stream, bytes); !request.empty())
    heard.asks_for_stream = heard.asks_for_stream || requests_samples(request, profile);
  return heard;
}

}  // namespace

// In framed_gyro_bytes.cpp.
GyroEncoder vectornav_encoder();
GyroEncoder xsens_encoder();
GyroEncoder hipnuc_encoder();
GyroEncoder mip_encoder();

std::span<const GyroEncoder> gyro_encoders() {
  static const std::array table{GyroEncoder{"witmotion", witmotion_bytes, witmotion_hear},
                                GyroEncoder{"text", text_bytes},
                                GyroEncoder{"mavlink", mavlink_bytes, mavlink_hear, mavlink_idle_bytes},
                                vectornav_encoder(),
                                xsens_encoder(),
                                hipnuc_encoder(),
                                mip_encoder()};
  return table;
}

const GyroEncoder& gyro_encoder(const GyroProfile& profile) {
  return encoder_named(gyro_encoders(), profile.protocol, "gyro");
}

}  // namespace thermorig::simulation

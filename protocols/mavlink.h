// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

/// Bytes of the MAVLink messages that carry a gyro. Description: mavlink_gyro.md.
namespace mavlink {

inline constexpr std::uint8_t sync_v2 = 0xFD;
inline constexpr std::uint8_t sync_v1 = 0xFE;

// A packet: header, payload, checksum and, if it is signed, a signature.
inline constexpr std::size_t header_v2_bytes = 10;
inline constexpr std::size_t header_v1_bytes = 6;
inline constexpr std::size_t checksum_bytes = 2;
inline constexpr std::size_t signature_bytes = 13;
inline constexpr std::size_t payload_max_bytes = 255;
inline constexpr std::size_t log_time_bytes = 8;  // before each packet of a ground station's log
inline constexpr std::size_t length_offset = 1;   // of both headers
inline constexpr std::size_t flags_offset = 2;    // version 2: those that a reader must understand
inline constexpr std::uint8_t flag_signed = 0x01;
inline constexpr std::size_t address_v2_offset = 4;  // sequence, system, component; the message's number
inline constexpr std::size_t address_v1_offset = 2;

/// A message of the common set. `payload_min`: without its later extensions; in version 1 it has just these.
struct Message {
  std::uint32_t id;
  std::uint8_t crc_extra;
  std::size_t payload_min, payload;
};

inline constexpr Message heartbeat{0, 50, 9, 9};
inline constexpr Message scaled_imu{26, 170, 22, 24};
inline constexpr Message raw_imu{27, 144, 26, 29};
inline constexpr Message request_data_stream{66, 148, 6, 6};
inline constexpr Message command_long{76, 152, 33, 33};
inline constexpr Message command_ack{77, 143, 3, 10};
inline constexpr Message highres_imu{105, 93, 62, 63};

// Offsets in the payloads.
inline constexpr std::size_t heartbeat_autopilot = 5;
inline constexpr std::size_t scaled_imu_time_ms = 0, scaled_imu_gyro = 10, scaled_imu_temperature = 22;
inline constexpr std::size_t raw_imu_time_us = 0, raw_imu_gyro = 14, raw_imu_id = 26,
                             raw_imu_temperature = 27;
inline constexpr std::size_t highres_imu_time_us = 0, highres_imu_gyro = 20, highres_imu_temperature = 56,
                             highres_imu_updated = 60, highres_imu_id = 62;

inline constexpr std::size_t command_long_parameters = 0, command_long_command = 28, command_long_system = 30,
                             command_long_component = 31, command_long_confirmation = 32;
inline constexpr std::size_t data_stream_rate_hz = 0, data_stream_system = 2, data_stream_component = 3,
                             data_stream_id = 4, data_stream_start = 5;
inline constexpr std::size_t command_ack_command = 0, command_ack_result = 2;

inline constexpr std::uint16_t set_message_interval = 511;  // parameters: message, interval in us
inline constexpr std::uint8_t raw_sensors_stream = 1;
inline constexpr std::uint8_t result_accepted = 0, result_unsupported = 3;

inline constexpr std::uint8_t autopilot_ardupilot = 3;  // MAV_AUTOPILOT: its RAW_IMU counts mrad/s

// Who we are: a ground station.
inline constexpr std::uint8_t host_system = 255, host_component = 190;

// Bits of highres_imu_updated.
inline constexpr std::uint16_t updated_gyro = 0x0038;
inline constexpr std::uint16_t updated_temperature = 0x1000;

inline constexpr double kelvin_per_count = 0.01;  // where a temperature is a whole number; 0: none

}  // namespace mavlink

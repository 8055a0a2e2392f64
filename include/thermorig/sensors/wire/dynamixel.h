// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thermorig::wire::dynamixel {

// Packets of Dynamixel's protocol 2.0, and the control table of the X series. Source: protocols/dynamixel.md.

using Bytes = std::span<const std::uint8_t>;

enum class Instruction : std::uint8_t { ping = 0x01, read = 0x02, write = 0x03, status = 0x55 };

inline constexpr std::uint8_t every_id = 0xFE;    // all act on it; only a ping is answered
inline constexpr std::uint8_t nobodys_id = 0xFC;  // whose pings are notes of ours: note()
inline constexpr std::uint8_t last_id = 0xFB;     // that a servo of ours may have

/// Where the control table has what.
namespace at {
inline constexpr std::uint16_t return_delay = 9;  // 2 us each
inline constexpr std::uint16_t drive_mode = 10;   // bit 2: profiles are stated as times
inline constexpr std::uint16_t operating_mode = 11;
inline constexpr std::uint16_t velocity_limit = 44;
inline constexpr std::uint16_t torque_enable = 64;
inline constexpr std::uint16_t hardware_error = 70;
inline constexpr std::uint16_t bus_watchdog = 98;  // 20 ms each; -1: it has tripped
inline constexpr std::uint16_t profile_acceleration = 108;
inline constexpr std::uint16_t profile_velocity = 112;
inline constexpr std::uint16_t goal_position = 116;
inline constexpr std::uint16_t tick = 120;  // ms, wraps
inline constexpr std::uint16_t present_position = 132;
inline constexpr std::uint16_t velocity_trajectory = 136;  // what its own profile wants now
inline constexpr std::uint16_t position_trajectory = 140;
}  // namespace at

inline constexpr std::uint8_t extended_position_mode = 4;
inline constexpr std::uint8_t time_based_profile = 0x04;  // in drive_mode
inline constexpr std::uint8_t watchdog_tripped = 0xFF;
inline constexpr std::uint8_t alert = 0x80;  // in a status packet's error: look at hardware_error
inline constexpr std::uint64_t tick_wrap = 32768;

inline constexpr double position_deg = 360.0 / 4096.0;               // a count
inline constexpr double velocity_dps = 0.229 * 6.0;                  // 0.229 rev/min
inline constexpr double acceleration_dps2 = 214.577 * 360.0 / 3600;  // 214.577 rev/min^2
inline constexpr std::int32_t middle_position = 2048;                // of a turn: 0 degrees

/// What telemetry reads in one go: from torque to the profile's position.
inline constexpr std::uint16_t telemetry_begin = at::torque_enable;
inline constexpr std::uint16_t telemetry_bytes = at::position_trajectory + 4 - telemetry_begin;

inline constexpr std::size_t around_parameters = 10;  // of an instruction; a status has one more
/// Longer ones are not ours, and not believed: no telemetry stuffed in full is as long.
inline constexpr std::size_t longest_packet = 160;

/// Polynomial 8005, start 0, not reflected; over all that comes before it.
std::uint16_t crc16(Bytes bytes);

/// A whole packet, stuffed and with its check sum.
std::vector<std::uint8_t> packet(std::uint8_t id, Instruction instruction, Bytes parameters);
std::vector<std::uint8_t> ping(std::uint8_t id);
std::vector<std::uint8_t> read(std::uint8_t id, std::uint16_t address, std::uint16_t bytes);
std::vector<std::uint8_t> write(std::uint8_t id, std::uint16_t address, Bytes data);

/// A note for readers of what was sent: from the next read on the servo drives this leg. To the servos it
/// is a ping to somebody who is not there.
std::vector<std::uint8_t> note(std::uint16_t leg);

/// Bytes of the packet that `rest` begins with; 0: more bytes are needed; none: no packet begins here.
std::optional<std::size_t> packet_size(Bytes rest);

struct Packet {
  std::uint8_t id = 0;
  Instruction instruction = Instruction::ping;
  std::uint8_t error = 0;                // of a status
  std::vector<std::uint8_t> parameters;  // not stuffed, without the error
};
/// Of a whole packet. None: its check sum does not fit, or it is a status without an error.
std::optional<Packet> parse(Bytes whole);

inline std::int32_t i32_at(Bytes bytes, std::size_t place) {
  std::uint32_t number = 0;
  for (std::size_t i = 4; i-- > 0;) number = number << 8U | bytes[place + i];
  return static_cast<std::int32_t>(number);
}
void put_i32(std::int32_t value, std::vector<std::uint8_t>& out);

}  // namespace thermorig::wire::dynamixel

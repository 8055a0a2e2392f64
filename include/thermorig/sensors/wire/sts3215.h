// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thermorig::wire::sts3215 {

// Packets of Feetech's bus servos, and the memory of the STS series. Source: protocols/sts3215.md.

using Bytes = std::span<const std::uint8_t>;

enum class Instruction : std::uint8_t { ping = 0x01, read = 0x02, write = 0x03 };

inline constexpr std::uint8_t every_id = 0xFE;    // all act on it; only a ping is answered
inline constexpr std::uint8_t nobodys_id = 0xFD;  // whose pings are notes of ours: note()

/// Where the memory has what.
namespace at {
inline constexpr std::uint16_t firmware = 0;      // two bytes; 2: order of bytes, 0 is little-endian
inline constexpr std::uint16_t model = 3;         // two bytes; the first is 9 for 4096 counts a turn
inline constexpr std::uint16_t return_delay = 7;  // 2 us each
inline constexpr std::uint16_t answers = 8;       // 1: writes are answered, too
inline constexpr std::uint16_t least_angle = 9;   // this and the next one 0: it counts turns
inline constexpr std::uint16_t phase = 18;
inline constexpr std::uint16_t mode = 33;  // 0: position
inline constexpr std::uint16_t torque_enable = 40;
inline constexpr std::uint16_t acceleration = 41;
inline constexpr std::uint16_t goal_position = 42;
inline constexpr std::uint16_t goal_speed = 46;
inline constexpr std::uint16_t lock = 55;  // 0: the EEPROM, up to 39, can be written
inline constexpr std::uint16_t present_position = 56;
inline constexpr std::uint16_t present_speed = 58;
inline constexpr std::uint16_t status = 65;
inline constexpr std::uint16_t moving = 66;
inline constexpr std::uint16_t present_current = 69;
}  // namespace at

inline constexpr std::uint8_t model_of_4096 = 9;
inline constexpr std::uint8_t phase_counts_turns = 0x10;

inline constexpr double position_deg = 360.0 / 4096.0;               // a count
inline constexpr double acceleration_dps2 = 100.0 * 360.0 / 4096.0;  // 100 counts a second squared
inline constexpr int most_acceleration = 254;
inline constexpr std::int32_t middle_position = 2048;     // of a turn: 0 degrees
inline constexpr std::int32_t farthest_position = 30719;  // either way: seven turns and a half

/// Errors after which the motor gives way: sensor, heat, current, overload. The others (voltage) do not stop
/// it.
inline constexpr std::uint8_t giving_way = 0x02 | 0x04 | 0x08 | 0x20;

// Bytes of the answers that are asked for. No instruction has as many parameters, so that the echo of one is
// not taken for an answer, whose packets look the same.
inline constexpr std::size_t identity_bytes = 7;
inline constexpr std::size_t position_bytes = 6;
inline constexpr std::size_t setting_bytes = at::phase + 1 - at::return_delay;
inline constexpr std::uint16_t telemetry_begin = at::torque_enable;
inline constexpr std::size_t telemetry_bytes = at::present_current + 2 - telemetry_begin;

inline constexpr std::size_t around_parameters = 6;
inline constexpr std::size_t longest_packet = around_parameters + telemetry_bytes;  // of ours

/// A whole packet with its check sum.
std::vector<std::uint8_t> packet(std::uint8_t id, std::uint8_t instruction_or_error, Bytes parameters);
std::vector<std::uint8_t> ping(std::uint8_t id);
std::vector<std::uint8_t> read(std::uint8_t id, std::uint16_t address, std::size_t bytes);
std::vector<std::uint8_t> write(std::uint8_t id, std::uint16_t address, Bytes data);

/// A note for readers of what was sent: from the next read on the servo drives this leg. To the servos it is
/// a ping to somebody who is not there.
std::vector<std::uint8_t> note(std::uint16_t leg);

/// Bytes of the packet that `rest` begins with; 0: more bytes are needed; none: no packet of ours begins
/// here.
std::optional<std::size_t> packet_size(Bytes rest);

struct Packet {
  std::uint8_t id = 0;
  std::uint8_t code = 0;  // an Instruction, or of an answer its error
  std::vector<std::uint8_t> parameters;
};
/// Of a whole packet. None: its check sum does not fit.
std::optional<Packet> parse(Bytes whole);

/// Is it an answer to what the program asks, and not an instruction that an adapter has sent back?
bool is_answer(const Packet& packet);

/// Two bytes at `place` of `bytes`: bit 15 is the sign.
std::int32_t signed_at(Bytes bytes, std::size_t place);
/// `value` from -32767 to 32767.
void put_signed(std::int32_t value, std::vector<std::uint8_t>& out);

}  // namespace thermorig::wire::sts3215

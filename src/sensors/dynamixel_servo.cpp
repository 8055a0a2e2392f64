// SPDX-License-Identifier: MIT
// Servos of Dynamixel's X series. Source: protocols/dynamixel.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "bus_servo.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/dynamixel.h"

namespace thermorig::sensors {

namespace {

namespace dynamixel = wire::dynamixel;
using dynamixel::Bytes;

constexpr std::size_t ping_answer_bytes = 3;  // model, firmware
constexpr double milliseconds_us = 1000.0;
constexpr std::uint64_t before_position =
    dynamixel::around_parameters - 1 + dynamixel::at::present_position - dynamixel::telemetry_begin;

/// A register's place within telemetry.
constexpr std::size_t in_telemetry(std::uint16_t address) {
  return address - dynamixel::telemetry_begin;
}

double angle_deg(Bytes telemetry, std::uint16_t address) {
  const std::int32_t counts = dynamixel::i32_at(telemetry, in_telemetry(address));
  return (static_cast<double>(counts) - dynamixel::middle_position) * dynamixel::position_deg;
}

ServoMotion motion(Bytes telemetry, std::int32_t velocity) {
  if (telemetry[in_telemetry(dynamixel::at::torque_enable)] == 0) return ServoMotion::disarmed;
  if (velocity == 0) return ServoMotion::holding;
  const std::int32_t profile = dynamixel::i32_at(telemetry, in_telemetry(dynamixel::at::profile_velocity));
  return std::abs(velocity) == profile ? ServoMotion::steady : ServoMotion::ramping;
}

/// Commanded is what the servo's own profile wants; without torque, where it stands.
ServoState servo_state(Bytes telemetry, std::uint16_t leg) {
  const std::size_t tick = in_telemetry(dynamixel::at::tick);
  const std::int32_t velocity =
      dynamixel::i32_at(telemetry, in_telemetry(dynamixel::at::velocity_trajectory));
  ServoState state{
      .mcu_us = static_cast<std::uint32_t>((telemetry[tick] | telemetry[tick + 1] << 8) * milliseconds_us),
      .motion = motion(telemetry, velocity),
      .leg = leg};
  const bool is_driven = state.motion != ServoMotion::disarmed;
  state.angle_deg =
      angle_deg(telemetry, is_driven ? dynamixel::at::position_trajectory : dynamixel::at::present_position);
  state.rate_dps = is_driven ? velocity * dynamixel::velocity_dps : 0.0;
  if (telemetry[in_telemetry(dynamixel::at::bus_watchdog)] == dynamixel::watchdog_tripped)
    state.fault = ServoFault::watchdog;
  return state;
}

ShaftReading shaft_reading(Bytes telemetry, const ServoState& state) {
  return {.mcu_us = state.mcu_us,
          .angle_deg = angle_deg(telemetry, dynamixel::at::present_position),
          .turn_deg = 0.0,
          .uncertainty_deg =
              reading_uncertainty_deg(dynamixel::position_deg, state.rate_dps, 1e-6 * milliseconds_us)};
}

/// Half-duplex adapters may send back what the host sent: an instruction, sound and of no use.
class DynamixelFraming {
 public:
  using Content = BusServoContent;
  static constexpr std::uint8_t sync = 0xFF;
  static constexpr std::size_t longest = dynamixel::longest_packet;

  explicit DynamixelFraming(std::uint8_t id) : id_(id) {}

  static std::optional<std::size_t> size(Bytes rest) { return dynamixel::packet_size(rest); }
  static bool is_good(Bytes frame) { return dynamixel::parse(frame).has_value(); }
  static bool is_proof(Bytes) { return true; }

  void sent(Bytes instruction) {
    const dynamixel::Packet packet = *dynamixel::parse(instruction);
    if (packet.instruction == dynamixel::Instruction::ping && packet.id == dynamixel::nobodys_id &&
        packet.parameters.size() == 2)
      legs_.noted(packet.parameters);
    if (packet.instruction == dynamixel::Instruction::read) legs_.asked();
  }

  Content read(Bytes frame) {
    dynamixel::Packet packet = *dynamixel::parse(frame);
    if (packet.instruction != dynamixel::Instruction::status) return {};
    const std::size_t size = packet.parameters.size();
    heard_.answers += 1;
    heard_.last_id = packet.id;
    if (size == ping_answer_bytes) return {.body = welcome(packet)};
    if (packet.id != id_) return {};
    if (size == dynamixel::telemetry_bytes) {
      const ServoState state = servo_state(packet.parameters, legs_.of_telemetry());
      return {.kind = FrameKind::sample,
              .body = state,
              .shaft = shaft_reading(packet.parameters, state),
              .before_shaft = before_position};
    }
    return {.body = wire::ServoReply{packet.id, packet.error, std::move(packet.parameters)}};
  }
  void restart() { legs_.restart(); }

  const HeardServos& heard() const { return heard_; }

 private:
  static wire::ServoWelcome welcome(const dynamixel::Packet& packet) {
    return {.firmware = fmt::format("{} of Dynamixel model {}", packet.parameters[2],
                                    packet.parameters[0] | packet.parameters[1] << 8),
            .board = packet.id};
  }

  std::uint8_t id_;
  NotedLegs legs_;
  HeardServos heard_;
};

constexpr std::array<UsualBaud, 3> dynamixel_bauds{{{57600, 0.15}, {1000000, 0.1}, {2000000, 0.1}}};
constexpr ClockProperties dynamixel_clock{
    .tick_s = 1e-3, .wrap_ticks = dynamixel::tick_wrap, .rate_error_max = 0.02};
constexpr std::uint64_t status_around = dynamixel::around_parameters + 1;
constexpr double polls_hz = 42.0;  // 50 where answers come at once, fewer behind a latency timer

ServoScanner dynamixel_scanner(const ServoProfile& profile) {
  return ServoScanner(BusServoScanner<DynamixelFraming>(profile.bus_id));
}

std::optional<Evidence> recognise_dynamixel(Bytes bytes) {
  return recognise_bus_servo<DynamixelFraming>(bytes, "status packets (Dynamixel, protocol 2.0)");
}

std::vector<std::uint8_t> ping_all() {
  return dynamixel::ping(dynamixel::every_id);
}

std::vector<std::uint8_t> torque_off() {
  return dynamixel::write(dynamixel::every_id, dynamixel::at::torque_enable, std::array<std::uint8_t, 1>{0});
}

}  // namespace

ServoProtocol dynamixel_servo() {
  return {.name = "dynamixel",
          .sends = "status packets (Dynamixel, protocol 2.0)",
          .greeted_as = "a ping",
          .bauds = dynamixel_bauds,
          .is_silent = true,
          .clock = dynamixel_clock,
          .message_bytes = dynamixel::telemetry_bytes + status_around,
          .rate_hz = polls_hz,
          .longest_gap_s = longest_silence_of_a_host_s,
          .shaft_sensor = "Dynamixel",
          .scanner = dynamixel_scanner,
          .recognise = recognise_dynamixel,
          .greeting = ping_all,
          .emergency_bytes = torque_off,
          .telemetry_request = [](const ServoProfile& profile) {
            return dynamixel::read(static_cast<std::uint8_t>(profile.bus_id), dynamixel::telemetry_begin,
                                   dynamixel::telemetry_bytes);
          }};
}

}  // namespace thermorig::sensors

// SPDX-License-Identifier: MIT
// Feetech's STS3215. Source: protocols/sts3215.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "bus_servo.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/sts3215.h"

namespace thermorig::sensors {

namespace {

namespace sts3215 = wire::sts3215;
using sts3215::Bytes;

constexpr double reached_share = 0.85;  // of the speed it was given: its own may be uneven (assumed)
constexpr double reached_counts = 3.0;  // and more than that slower does not show in its speed
constexpr int settled = 6;              // messages with that speed, until its loop has caught up
// A load that keeps it off its goal has it say for ever that it moves.
constexpr std::int32_t near_counts = 45, slow_counts_s = 20;  // 4 deg, 2 deg/s
constexpr double ramp_margin = 1.2;                           // of the way in which it comes to rest
constexpr double arrival_s = 0.001;                           // it sends no time
constexpr std::uint64_t before_present_position =
    sts3215::around_parameters - 1 + sts3215::at::present_position - sts3215::telemetry_begin;

/// A register's place within telemetry.
constexpr std::size_t place_of(std::uint16_t address) {
  return address - sts3215::telemetry_begin;
}

std::int32_t signed_in(Bytes telemetry, std::uint16_t address) {
  return sts3215::signed_at(telemetry, place_of(address));
}

double angle_deg_of(std::int32_t position) {
  return (static_cast<double>(position) - sts3215::middle_position) * sts3215::position_deg;
}

/// It does not say where its profile is, so that this is concluded from the goal it has, and from whether it
/// has reached the speed that goes with it.
class ProfileWatch {
 public:
  ServoState state(Bytes telemetry, std::uint16_t leg) {
    const std::int32_t position = signed_in(telemetry, sts3215::at::present_position);
    const std::int32_t goal = signed_in(telemetry, sts3215::at::goal_position);
    const std::int32_t asked = std::abs(signed_in(telemetry, sts3215::at::goal_speed));
    const std::int32_t speed = signed_in(telemetry, sts3215::at::present_speed);
    if (goal != goal_ || asked != asked_) with_speed_ = 0;
    goal_ = goal;
    asked_ = asked;
    ServoState state{.angle_deg = angle_deg_of(position), .leg = leg, .is_measured = true};
    if (telemetry[place_of(sts3215::at::torque_enable)] == 0) return state;
    const bool is_there = std::abs(goal - position) <= near_counts && std::abs(speed) <= slow_counts_s;
    if (telemetry[place_of(sts3215::at::moving)] == 0 || is_there) {
      state.motion = ServoMotion::holding;
      return state;
    }
    const double direction = goal < position ? -1.0 : 1.0;
    if (direction * speed >= reached_share * asked - reached_counts && with_speed_ < settled) ++with_speed_;
    const bool is_steady =
        with_speed_ >= settled && std::abs(goal - position) > ramp_margin * counts_to_rest(telemetry);
    state.motion = is_steady ? ServoMotion::steady : ServoMotion::ramping;
    state.rate_dps = (is_steady ? direction * asked : speed) * sts3215::position_deg;
    return state;
  }
  void restart() { with_speed_ = 0; }

 private:
  double counts_to_rest(Bytes telemetry) const {
    const double change = 100.0 * telemetry[place_of(sts3215::at::acceleration)];
    return change > 0.0 ? static_cast<double>(asked_) * asked_ / (2.0 * change) : 0.0;
  }

  std::int32_t goal_ = 0, asked_ = 0;
  int with_speed_ = 0;  // messages since its goal
};

ShaftReading reading_of(const ServoState& state) {
  return {.angle_deg = state.angle_deg,
          .turn_deg = 0.0,
          .uncertainty_deg = reading_uncertainty_deg(sts3215::position_deg, state.rate_dps, arrival_s)};
}

class Sts3215Framing {
 public:
  using Content = BusServoContent;
  static constexpr std::uint8_t sync = 0xFF;
  static constexpr std::size_t longest = sts3215::longest_packet;

  explicit Sts3215Framing(std::uint8_t id) : id_(id) {}

  static std::optional<std::size_t> size(Bytes rest) { return sts3215::packet_size(rest); }
  static bool is_good(Bytes frame) { return sts3215::parse(frame).has_value(); }
  static bool is_proof(Bytes) { return true; }

  void sent(Bytes instruction) {
    const sts3215::Packet packet = *sts3215::parse(instruction);
    if (packet.id == sts3215::nobodys_id && packet.parameters.size() == 2) legs_.noted(packet.parameters);
    if (packet.code == static_cast<std::uint8_t>(sts3215::Instruction::read)) legs_.asked();
  }

  Content read(Bytes frame) {
    sts3215::Packet packet = *sts3215::parse(frame);
    if (!sts3215::is_answer(packet)) return {};
    heard_.answers += 1;
    heard_.last_id = packet.id;
    const std::size_t size = packet.parameters.size();
    if (size == sts3215::identity_bytes) return {.body = welcome(packet)};
    if (size == sts3215::telemetry_bytes) return packet.id == id_ ? telemetry(packet) : Content();
    return {.body = wire::ServoReply{packet.id, packet.code, std::move(packet.parameters)}};
  }
  void restart() {
    legs_.restart();
    profile_.restart();
  }

  const HeardServos& heard() const { return heard_; }

 private:
  Content telemetry(const sts3215::Packet& packet) {
    const ServoState state = profile_.state(packet.parameters, legs_.of_telemetry());
    Content content{.kind = FrameKind::sample,
                    .body = state,
                    .shaft = reading_of(state),
                    .before_shaft = before_present_position};
    if ((packet.code & sts3215::giving_way) != 0)
      content.trouble = wire::ServoReply{packet.id, packet.code, {}};
    return content;
  }

  static wire::ServoWelcome welcome(const sts3215::Packet& packet) {
    const auto& memory = packet.parameters;
    return {.version = memory[sts3215::at::model],
            .firmware = fmt::format("{}.{} of Feetech model {}.{}", memory[0], memory[1],
                                    memory[sts3215::at::model], memory[sts3215::at::model + 1]),
            .board = packet.id};
  }

  std::uint8_t id_;
  ProfileWatch profile_;
  NotedLegs legs_;
  HeardServos heard_;
};

constexpr std::array<UsualBaud, 2> sts3215_bauds{{{1000000, 0.1}, {115200, 0.1}}};
constexpr double answers_hz = 42.0;  // as a Dynamixel's

/// Short packets with a sum of one byte are no proof within other bytes.
std::optional<Evidence> recognise_sts3215(Bytes bytes) {
  auto evidence =
      recognise_bus_servo<Sts3215Framing>(bytes, "status packets (Feetech, or Dynamixel of protocol 1.0)");
  if (evidence && 2 * evidence->bytes < bytes.size()) return std::nullopt;
  return evidence;
}

}  // namespace

ServoProtocol sts3215_servo() {
  return {.name = "sts3215",
          .sends = "status packets (Feetech STS)",
          .greeted_as = "a ping",
          .bauds = sts3215_bauds,
          .is_silent = true,
          .clock = {},
          .message_bytes = sts3215::longest_packet,
          .rate_hz = answers_hz,
          .longest_gap_s = longest_silence_of_a_host_s,
          .shaft_sensor = "STS3215",
          .scanner =
              [](const ServoProfile& profile) {
                return ServoScanner(BusServoScanner<Sts3215Framing>(profile.bus_id));
              },
          .recognise = recognise_sts3215,
          .greeting = [] { return sts3215::ping(sts3215::every_id); },
          .emergency_bytes =
              [] {
                return sts3215::write(sts3215::every_id, sts3215::at::torque_enable,
                                      std::array<std::uint8_t, 1>{0});
              },
          .telemetry_request =
              [](const ServoProfile& profile) {
                return sts3215::read(static_cast<std::uint8_t>(profile.bus_id), sts3215::telemetry_begin,
                                     sts3215::telemetry_bytes);
              }};
}

}  // namespace thermorig::sensors

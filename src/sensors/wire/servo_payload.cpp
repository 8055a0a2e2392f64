// SPDX-License-Identifier: MIT
#include "servo_payload.h"

#include <fmt/format.h>

namespace thermorig::wire {

namespace {

/// Takes little-endian numbers from a payload, in the order in which protocols/servo_link.h declares them.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::uint8_t> payload) : at_(payload.data()) {}

  std::uint8_t u8() { return *at_++; }
  std::uint16_t u16() {
    at_ += 2;
    return servo_get_u16(at_ - 2);
  }
  std::uint32_t u32() {
    at_ += 4;
    return servo_get_u32(at_ - 4);
  }
  double hundredths() { return static_cast<std::int32_t>(u32()) / 100.0; }  // i32 centi-units

 private:
  const std::uint8_t* at_;
};

ServoState read_telemetry(PayloadReader in) {
  ServoState state;
  state.mcu_us = in.u32();
  state.angle_deg = in.hundredths();
  state.rate_dps = in.hundredths();
  const std::uint16_t pulse_ticks = in.u16();
  const std::uint8_t motion = in.u8();
  const bool fine = (motion & SERVO_FINE_TICKS) != 0;
  const unsigned ticks_per_us = fine ? SERVO_TICKS_PER_US : SERVO_COARSE_TICKS_PER_US;
  state.pulse_us = static_cast<float>(pulse_ticks) / static_cast<float>(ticks_per_us);
  state.motion = static_cast<ServoMotion>(motion & ~SERVO_FINE_TICKS);
  state.fault = static_cast<ServoFault>(in.u8());
  state.leg = in.u16();
  return state;
}

ServoWelcome read_welcome(PayloadReader in) {
  ServoWelcome welcome;
  welcome.version = in.u8();
  const unsigned major = in.u8();
  const unsigned minor = in.u8();
  const unsigned patch = in.u8();
  welcome.firmware = fmt::format("{}.{}.{}", major, minor, patch);
  welcome.board = in.u8();
  welcome.reset_cause = in.u8();
  welcome.uptime_us = in.u32();
  welcome.limit_pulse_min_us = in.u16();
  welcome.limit_pulse_max_us = in.u16();
  welcome.limit_rate_dps = in.u32() / 100.0;
  welcome.limit_acceleration_dps2 = in.u16();
  welcome.watchdog_ms = in.u16();
  return welcome;
}

ServoAck read_ack(PayloadReader in) {
  ServoAck ack;
  ack.type = in.u8();
  ack.mcu_us = in.u32();
  return ack;
}

ServoNack read_nack(PayloadReader in) {
  ServoNack nack;
  nack.type = in.u8();
  nack.reason = in.u8();
  nack.detail = in.u8();
  return nack;
}

ServoPong read_pong(PayloadReader in) {
  ServoPong pong;
  pong.token = in.u32();
  pong.receive_us = in.u32();
  pong.send_us = in.u32();
  return pong;
}

ServoEvent read_event(PayloadReader in) {
  ServoEvent event;
  event.kind = in.u8();
  event.detail = in.u16();
  event.mcu_us = in.u32();
  return event;
}

/// The first byte is the version in every version of the link; the rest may have changed.
bool is_foreign_welcome(std::uint8_t type, std::span<const std::uint8_t> payload) {
  return type == SERVO_WELCOME && !payload.empty() && payload[0] != SERVO_LINK_VERSION;
}

/// Telemetry whose motion or fault this version of the link does not know says nothing certain.
std::optional<ServoBody> read_known_telemetry(PayloadReader in) {
  const ServoState state = read_telemetry(in);
  if (state.motion > ServoMotion::stopping || state.fault > ServoFault::bad_frames) return std::nullopt;
  return state;
}

}  // namespace

std::size_t servo_payload_size(std::uint8_t type) {
  switch (type) {
    case SERVO_WELCOME:
      return SERVO_WELCOME_SIZE;
    case SERVO_ACK:
      return SERVO_ACK_SIZE;
    case SERVO_NACK:
      return SERVO_NACK_SIZE;
    case SERVO_TELEMETRY:
      return SERVO_TELEMETRY_SIZE;
    case SERVO_PONG:
      return SERVO_PONG_SIZE;
    case SERVO_EVENT:
      return SERVO_EVENT_SIZE;
    default:
      return 0;
  }
}

std::optional<ServoBody> read_servo_payload(std::uint8_t type, std::span<const std::uint8_t> payload) {
  if (is_foreign_welcome(type, payload)) return ServoWelcome{.version = payload[0]};
  if (payload.size() != servo_payload_size(type)) return std::nullopt;
  const PayloadReader in(payload);
  switch (type) {
    case SERVO_WELCOME:
      return read_welcome(in);
    case SERVO_ACK:
      return read_ack(in);
    case SERVO_NACK:
      return read_nack(in);
    case SERVO_TELEMETRY:
      return read_known_telemetry(in);
    case SERVO_PONG:
      return read_pong(in);
    case SERVO_EVENT:
      return read_event(in);
    default:
      return std::nullopt;
  }
}

}  // namespace thermorig::wire

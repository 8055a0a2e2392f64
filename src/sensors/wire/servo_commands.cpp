// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

namespace {

/// Rounds to a field of the link. A value that does not fit is a bug of the caller.
template <typename Integer>
Integer field(double value, const char* name) {
  const double rounded = std::round(value);
  if (!(rounded >= static_cast<double>(std::numeric_limits<Integer>::min()) &&
        rounded <= static_cast<double>(std::numeric_limits<Integer>::max()))) {
    std::fprintf(stderr, "bug: %s = %g does not fit its field of the servo link\n", name, value);
    std::abort();
  }
  return static_cast<Integer>(rounded);
}

/// Puts little-endian numbers into a payload, in the order in which protocols/servo_link.h declares them.
class PayloadWriter {
 public:
  PayloadWriter& u8(std::uint8_t value) {
    *at_++ = value;
    return *this;
  }
  PayloadWriter& u16(std::uint16_t value) {
    at_ = servo_put_u16(at_, value);
    return *this;
  }
  PayloadWriter& u32(std::uint32_t value) {
    at_ = servo_put_u32(at_, value);
    return *this;
  }
  PayloadWriter& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }

  /// The whole frame on the wire.
  std::vector<std::uint8_t> frame(std::uint8_t type, std::uint8_t sequence) const {
    std::array<std::uint8_t, SERVO_FRAME_MAX> bytes{};
    const auto size = static_cast<std::uint8_t>(at_ - payload_.data());
    const std::uint8_t length = servo_frame(bytes.data(), type, sequence, payload_.data(), size);
    return {bytes.begin(), bytes.begin() + length};
  }

 private:
  std::array<std::uint8_t, SERVO_PAYLOAD_MAX> payload_{};
  std::uint8_t* at_ = payload_.data();
};

std::vector<std::uint8_t> empty_frame(std::uint8_t type, std::uint8_t sequence) {
  return PayloadWriter().frame(type, sequence);
}

/// What the pulse range spans: degrees of travel, or degrees per second from full speed back to full speed
/// ahead.
double span_of(const ServoProfile& servo) {
  return servo.kind == ServoKind::continuous ? 2.0 * servo.full_rate_dps : servo.travel_deg;
}

/// Largest angle on either side of the middle; of a continuous servo, of where its cable is not twisted: 0 if
/// it has none to guard.
double angle_limit_deg(const ServoProfile& servo) {
  if (servo.kind == ServoKind::continuous && servo.travel_deg == 0.0) return 0.0;
  return servo.travel_deg / 2.0 - servo.stop_margin_deg;
}

}  // namespace

std::vector<std::uint8_t> hello_bytes(std::uint8_t sequence) {
  return PayloadWriter().u8(SERVO_LINK_VERSION).frame(SERVO_HELLO, sequence);
}

std::vector<std::uint8_t> asking_hello_bytes(std::uint8_t sequence) {
  return PayloadWriter().u8(SERVO_LINK_VERSION).u8(SERVO_ASK_SHAFT).frame(SERVO_HELLO, sequence);
}

std::vector<std::uint8_t> configure_bytes(std::uint8_t sequence, const ServoProfile& servo) {
  const double limit_deg = angle_limit_deg(servo);
  return PayloadWriter()
      .u8(static_cast<std::uint8_t>(servo.kind))
      .u16(field<std::uint16_t>(servo.pulse_min_us, "pulse_min_us"))
      .u16(field<std::uint16_t>(servo.pulse_max_us, "pulse_max_us"))
      .u32(field<std::uint32_t>(100.0 * span_of(servo), "span"))
      .u32(field<std::uint32_t>(100.0 * servo.max_rate_dps, "limit_rate_cdps"))
      .u16(field<std::uint16_t>(servo.acceleration_dps2, "limit_acceleration_dps2"))
      .i32(field<std::int32_t>(-100.0 * limit_deg, "angle_min_cdeg"))
      .i32(field<std::int32_t>(100.0 * limit_deg, "angle_max_cdeg"))
      .frame(SERVO_CONFIGURE, sequence);
}

std::vector<std::uint8_t> arm_bytes(std::uint8_t sequence, double angle_deg) {
  return PayloadWriter().i32(field<std::int32_t>(100.0 * angle_deg, "angle_cdeg")).frame(SERVO_ARM, sequence);
}

std::vector<std::uint8_t> disarm_bytes(std::uint8_t sequence) {
  return empty_frame(SERVO_DISARM, sequence);
}

std::vector<std::uint8_t> halt_bytes(std::uint8_t sequence) {
  return empty_frame(SERVO_HALT, sequence);
}

std::vector<std::uint8_t> refresh_bytes() {
  return empty_frame(SERVO_REFRESH, 0);
}

std::vector<std::uint8_t> ping_bytes(std::uint32_t token, std::uint16_t delay_max_us) {
  return PayloadWriter().u32(token).u16(delay_max_us).frame(SERVO_PING, 0);
}

std::vector<std::uint8_t> run_bytes(std::uint8_t sequence, const RunCommand& run) {
  return PayloadWriter()
      .u16(run.leg)
      .u8(run.turn_back ? SERVO_RUN_TURN_BACK : 0U)
      .i32(field<std::int32_t>(100.0 * run.rate_dps, "rate_cdps"))
      .u16(field<std::uint16_t>(run.acceleration_dps2, "acceleration_dps2"))
      .u32(field<std::uint32_t>(1000.0 * run.duration_s, "duration_ms"))
      .frame(SERVO_RUN, sequence);
}

std::vector<std::uint8_t> go_to_bytes(std::uint8_t sequence, const GoToCommand& go_to) {
  return PayloadWriter()
      .i32(field<std::int32_t>(100.0 * go_to.angle_deg, "angle_cdeg"))
      .u32(field<std::uint32_t>(100.0 * go_to.rate_dps, "rate_cdps"))
      .u16(field<std::uint16_t>(go_to.acceleration_dps2, "acceleration_dps2"))
      .frame(SERVO_GO_TO, sequence);
}

std::vector<std::uint8_t> stop_bytes() {
  return {SERVO_LINK_STOP};
}

}  // namespace thermorig::wire

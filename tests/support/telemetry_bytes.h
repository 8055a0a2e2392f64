// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "servo_link.h"
#include "thermorig/core/reading.h"

namespace thermorig::test {

/// A telemetry message as firmware 1.1.0 and later send it.
inline std::vector<std::uint8_t> telemetry_bytes(std::uint8_t sequence, const ServoState& state) {
  const auto hundredths = [](double value) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(100.0 * value)));
  };
  std::array<std::uint8_t, SERVO_TELEMETRY_SIZE> payload{};
  std::uint8_t* at = servo_put_u32(payload.data(), state.mcu_us);
  at = servo_put_u32(at, hundredths(state.angle_deg));
  at = servo_put_u32(at, hundredths(state.rate_dps));
  at =
      servo_put_u16(at, static_cast<std::uint16_t>(std::lround(double{SERVO_TICKS_PER_US} * state.pulse_us)));
  *at++ = static_cast<std::uint8_t>(SERVO_FINE_TICKS | static_cast<unsigned>(state.motion));
  *at++ = static_cast<std::uint8_t>(state.fault);
  servo_put_u16(at, state.leg);
  std::array<std::uint8_t, SERVO_FRAME_MAX> frame{};
  const std::uint8_t size =
      servo_frame(frame.data(), SERVO_TELEMETRY, sequence, payload.data(), SERVO_TELEMETRY_SIZE);
  return {frame.begin(), frame.begin() + size};
}

}  // namespace thermorig::test

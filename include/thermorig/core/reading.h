// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace thermorig {

/// One gyro sample as the device sent it: all three axes, bias not removed, no sign or axis applied.
struct GyroReading {
  std::array<float, 3> rate_dps{};             // x, y, z, degrees per second
  std::array<std::int16_t, 3> counts{};        // what was on the wire, where the protocol has counts
  std::optional<float> temp_c;                 // the gyro's own temperature
  std::optional<std::int64_t> device_time_us;  // the device's own time, where it sends one
  bool saturated = false;                      // a count at either end of its range

  /// About all axes exactly: some gyros set themselves to zero at rest, which hides their bias.
  bool is_zero() const { return rate_dps == std::array<float, 3>{}; }
};

/// Five times the range of any gyro at hand, at most; false for NaN.
constexpr bool is_rate(float rate_dps) {
  return rate_dps >= -10'000.0F && rate_dps <= 10'000.0F;
}

/// Motion state that the servo firmware reports. Values are those of protocols/servo_link.h.
enum class ServoMotion : std::uint8_t { disarmed = 0, holding = 1, ramping = 2, steady = 3, stopping = 4 };

/// Why the servo stopped by itself. Values are those of protocols/servo_link.h.
enum class ServoFault : std::uint8_t { none = 0, watchdog = 1, stop_byte = 2, limit = 3, bad_frames = 4 };

/// One telemetry message of the servo firmware (100 per second).
struct ServoState {
  std::uint32_t mcu_us = 0;  // the micro-controller's time, wraps after 71.6 minutes
  double angle_deg = 0.0;    // commanded angle at that time
  double rate_dps = 0.0;     // commanded speed at that time, after the acceleration limit
  float pulse_us = 0.0F;     // width of the last pulse put out, exact in telemetry's ticks; 0: no pulse
  ServoMotion motion = ServoMotion::disarmed;
  ServoFault fault = ServoFault::none;
  std::uint16_t leg = 0;     // the leg that is being driven, 0 for none (rest, transit)
  bool is_measured = false;  // angle_deg is the shaft's: the device does not say what it commands
};

/// Whether a measured angle of the shaft can be trusted. The numbers are stored in files.
enum class ShaftStatus : std::uint8_t {
  good = 0,
  weak = 1,    // what it measures by is weak: more noise, larger errors
  strong = 2,  // or so strong that it is distorted
  absent = 3,  // there is nothing to measure, e.g. no magnet: no angle
  silent = 4,  // the sensor did not answer: no angle
};
inline constexpr ShaftStatus last_shaft_status = ShaftStatus::silent;

/// Where a sensor on the shaft has it, as the device sent it.
struct ShaftReading {
  std::uint32_t mcu_us = 0;      // when it was read, by the clock of ServoState::mcu_us
  double angle_deg = 0.0;        // in the sensor's own direction and from its own zero
  double turn_deg = 360.0;       // after so much it begins anew at 0; 0: the device counts turns
  float uncertainty_deg = 0.0F;  // resolution and noise of one reading, one standard deviation
  ShaftStatus status = ShaftStatus::good;
  std::uint16_t gain = 0;  // how much the sensor has to amplify, in its own units; 0: not said
};

inline bool has_angle(const ShaftReading& reading) {
  return reading.status != ShaftStatus::absent && reading.status != ShaftStatus::silent;
}

/// The servo was told to stand still: it holds or is disarmed, and its commanded speed is 0.
inline bool is_at_rest(const ServoState& state) {
  const bool still = state.motion == ServoMotion::holding || state.motion == ServoMotion::disarmed;
  return still && state.rate_dps == 0.0;
}

}  // namespace thermorig

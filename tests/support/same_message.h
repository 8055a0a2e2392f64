// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/gyro_message.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::test {

// Whether two messages are equal in everything that a scanner says about them.

/// A temperature that the camera does not say is not a number.
inline bool same_or_unknown(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

inline bool same(const wire::CameraMessage& a, const wire::CameraMessage& b) {
  return a.frame.temp_c == b.frame.temp_c && same_or_unknown(a.frame.sensor_temp_c, b.frame.sensor_temp_c) &&
         a.fresh.even == b.fresh.even && a.fresh.odd == b.fresh.odd && a.span == b.span &&
         a.resync_before == b.resync_before;
}

inline bool same(const wire::GyroMessage& a, const wire::GyroMessage& b) {
  return a.reading.rate_dps == b.reading.rate_dps && a.reading.counts == b.reading.counts &&
         a.reading.temp_c == b.reading.temp_c && a.reading.device_time_us == b.reading.device_time_us &&
         a.reading.saturated == b.reading.saturated && a.span == b.span && a.lost_before == b.lost_before;
}

inline bool same(const ServoState& a, const ServoState& b) {
  return a.mcu_us == b.mcu_us && a.angle_deg == b.angle_deg && a.rate_dps == b.rate_dps &&
         a.pulse_us == b.pulse_us && a.motion == b.motion && a.fault == b.fault && a.leg == b.leg;
}

inline bool same(const wire::ServoWelcome& a, const wire::ServoWelcome& b) {
  return a.version == b.version && a.firmware == b.firmware && a.board == b.board &&
         a.reset_cause == b.reset_cause && a.uptime_us == b.uptime_us &&
         a.limit_pulse_min_us == b.limit_pulse_min_us && a.limit_pulse_max_us == b.limit_pulse_max_us &&
         a.limit_rate_dps == b.limit_rate_dps && a.limit_acceleration_dps2 == b.limit_acceleration_dps2 &&
         a.watchdog_ms == b.watchdog_ms;
}

inline bool same(const wire::ServoAck& a, const wire::ServoAck& b) {
  return a.type == b.type && a.mcu_us == b.mcu_us;
}

inline bool same(const wire::ServoNack& a, const wire::ServoNack& b) {
  return a.type == b.type && a.reason == b.reason && a.detail == b.detail;
}

inline bool same(const wire::ServoPong& a, const wire::ServoPong& b) {
  return a.token == b.token && a.receive_us == b.receive_us && a.send_us == b.send_us;
}

inline bool same(const wire::ServoEvent& a, const wire::ServoEvent& b) {
  return a.kind == b.kind && a.detail == b.detail && a.mcu_us == b.mcu_us;
}

inline bool same(const ShaftReading& a, const ShaftReading& b) {
  return a.mcu_us == b.mcu_us && a.angle_deg == b.angle_deg && a.turn_deg == b.turn_deg &&
         a.uncertainty_deg == b.uncertainty_deg && a.status == b.status && a.gain == b.gain;
}

inline bool same(const wire::ServoMessage& a, const wire::ServoMessage& b) {
  if (a.body.index() != b.body.index() || a.sequence != b.sequence || !(a.span == b.span) ||
      a.lost_before != b.lost_before)
    return false;
  return std::visit(
      [&](const auto& body) { return same(body, std::get<std::decay_t<decltype(body)>>(b.body)); }, a.body);
}

}  // namespace thermorig::test

// SPDX-License-Identifier: MIT
#include "thermorig/rig/link_load.h"

#include "servo_link.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::rig {

namespace {

constexpr std::uint64_t servo_frame_bytes = 6;  // type, sequence, CRC, two flags: protocols/servo_link.md
constexpr std::uint64_t telemetry_bytes = SERVO_TELEMETRY_SIZE + servo_frame_bytes;

}  // namespace

LinkLoad link_load(Device device, const RigProfile& profile) {
  switch (device) {
    case Device::camera:
      return {wire::camera_frame_bytes, profile.camera.output_rate_hz};
    case Device::gyro:
      return {sensors::gyro_protocol(profile.gyro.protocol).message_bytes(profile.gyro),
              profile.gyro.output_rate_hz};
    case Device::servo:
      break;
  }
  return {telemetry_bytes, 1e3 / SERVO_TELEMETRY_PERIOD_MS};
}

}  // namespace thermorig::rig

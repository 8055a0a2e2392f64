// SPDX-License-Identifier: MIT
#include "thermorig/rig/link_load.h"

#include <algorithm>

#include "servo_link.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::rig {

namespace {

constexpr std::uint64_t text_field_bytes = 8;  // a number as text, such as "-123.45", and its separator
constexpr std::uint64_t line_end_bytes = 2;
constexpr std::uint64_t servo_frame_bytes = 6;  // type, sequence, CRC, two flags: protocols/servo_link.md
constexpr std::uint64_t telemetry_bytes = SERVO_TELEMETRY_SIZE + servo_frame_bytes;

/// A line as long as the columns that are read; what a device prints behind them is not known.
std::uint64_t text_line_bytes(const TextColumns& text) {
  const int last = std::max(text.time, *std::max_element(text.rate.begin(), text.rate.end()));
  return text.prefix.size() + text_field_bytes * static_cast<std::uint64_t>(last + 1) + line_end_bytes;
}

}  // namespace

LinkLoad link_load(Device device, const RigProfile& profile) {
  switch (device) {
    case Device::camera:
      return {wire::camera_frame_bytes, profile.camera.output_rate_hz};
    case Device::gyro:
      return {profile.gyro.protocol == GyroProtocol::text ? text_line_bytes(profile.gyro.text)
                                                          : wire::witmotion_packet_bytes,
              profile.gyro.output_rate_hz};
    case Device::servo:
      break;
  }
  return {telemetry_bytes, 1e3 / SERVO_TELEMETRY_PERIOD_MS};
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig {

using Bytes = std::vector<std::uint8_t>;

inline simulation::VirtualRigConfig rig_config() {
  return simulation::default_rig(3, "garden");
}

/// What a program has read from the three ports.
struct Heard {
  void take(Device device, std::span<const std::uint8_t> chunk) {
    bytes[device].insert(bytes[device].end(), chunk.begin(), chunk.end());
    if (device == Device::camera) camera_scanner.push(chunk, frames);
    if (device == Device::gyro) gyro_scanner.push(chunk, gyro);
    if (device == Device::servo) servo_scanner.push(chunk, servo);
  }

  template <typename Body>
  std::size_t count() const {
    return static_cast<std::size_t>(std::count_if(servo.begin(), servo.end(), [](const auto& message) {
      return std::holds_alternative<Body>(message.body);
    }));
  }

  bool is_undamaged() const {
    return camera_scanner.counters().bad_checksum + gyro_scanner.counters().bad_checksum +
               servo_scanner.counters().bad_checksum + servo_scanner.counters().lost ==
           0;
  }

  PerDevice<Bytes> bytes;
  std::vector<wire::CameraMessage> frames;
  std::vector<wire::GyroMessage> gyro;
  std::vector<wire::ServoMessage> servo;
  wire::CameraScanner camera_scanner;
  sensors::GyroScanner gyro_scanner = sensors::gyro_scanner(simulation::default_profile().gyro);
  wire::ServoScanner servo_scanner;
};

}  // namespace thermorig

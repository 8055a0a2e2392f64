// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace thermorig {

/// The three roles of a rig. The values are stored in journals and sessions: never renumber them.
enum class Device : std::uint8_t { camera = 0, gyro = 1, servo = 2 };

inline constexpr std::size_t device_count = 3;
inline constexpr std::array<Device, device_count> all_devices{Device::camera, Device::gyro, Device::servo};

constexpr std::size_t index_of(Device device) {
  return static_cast<std::size_t>(device);
}

constexpr std::string_view name_of(Device device) {
  constexpr std::array<std::string_view, device_count> names{"camera", "gyro", "servo"};
  return names[index_of(device)];
}

/// One value for each device, e.g. `PerDevice<std::string> ports`.
template <typename T>
struct PerDevice {
  std::array<T, device_count> values{};
  T& operator[](Device device) { return values[index_of(device)]; }
  const T& operator[](Device device) const { return values[index_of(device)]; }
};

}  // namespace thermorig

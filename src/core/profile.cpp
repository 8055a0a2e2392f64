// SPDX-License-Identifier: MIT
#include "thermorig/core/profile.h"

namespace thermorig {

double GyroProfile::setting(const std::string& setting_name) const {
  const auto found = settings.find(setting_name);
  return found == settings.end() ? 0.0 : found->second;
}

PortProfile& RigProfile::link(Device device) {
  return const_cast<PortProfile&>(static_cast<const RigProfile&>(*this).link(device));
}

const PortProfile& RigProfile::link(Device device) const {
  switch (device) {
    case Device::camera:
      return camera.link;
    case Device::gyro:
      return gyro.link;
    case Device::servo:
      break;
  }
  return servo.link;
}

}  // namespace thermorig

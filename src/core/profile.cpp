// SPDX-License-Identifier: MIT
#include "thermorig/core/profile.h"

namespace thermorig {

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

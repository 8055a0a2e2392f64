// SPDX-License-Identifier: MIT
#include "thermorig/rig/link_load.h"

#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

LinkLoad link_load(Device device, const RigProfile& profile) {
  const sensors::DeviceStream stream = sensors::device_stream(device, profile);
  return {stream.message_bytes, stream.rate_hz};
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#include "virtual_bus.h"

namespace thermorig::app {

VirtualBus::VirtualBus(const simulation::VirtualRigConfig& config)
    : rig_(config, simulation::make_host_firmware()) {}

void VirtualBus::send(Device to, std::span<const std::uint8_t> bytes, HostTime now) {
  rig_.send(to, bytes, now);
}

std::vector<Chunk> VirtualBus::advance(HostTime until) {
  return rig_.advance(until);
}

}  // namespace thermorig::app

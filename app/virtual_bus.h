// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/rig/virtual_recording.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::app {

/// The simulated rig as the devices of a recording in virtual time, with the firmware's host build.
class VirtualBus : public rig::DeviceBus {
 public:
  explicit VirtualBus(const simulation::VirtualRigConfig& config);
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override;
  std::vector<Chunk> advance(HostTime until) override;

 private:
  simulation::VirtualRig rig_;
};

}  // namespace thermorig::app

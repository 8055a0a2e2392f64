// SPDX-License-Identifier: MIT
#include "virtual_bus.h"

namespace thermorig::app {

namespace {

/// The simulated rig as the devices of a recording in virtual time.
class VirtualBus : public rig::DeviceBus {
 public:
  explicit VirtualBus(const simulation::VirtualRigConfig& config)
      : rig_(config, simulation::make_host_firmware()) {}
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override {
    rig_.send(to, bytes, now);
  }
  std::vector<Chunk> advance(HostTime until) override { return rig_.advance(until); }

 private:
  simulation::VirtualRig rig_;
};

}  // namespace

rig::RecordingResult record_virtual(const simulation::VirtualRigConfig& config, rig::VirtualOptions options) {
  VirtualBus bus(config);
  options.start = config.start;
  return rig::record_virtual(bus, options);
}

}  // namespace thermorig::app

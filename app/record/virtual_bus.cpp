// SPDX-License-Identifier: MIT
#include "virtual_bus.h"

namespace thermorig::app {

namespace {

/// The simulated rig as the devices of a recording in virtual time.
class VirtualBus : public rig::DeviceBus {
 public:
  /// What `profile` does not have has no port, though the simulated rig may have it.
  VirtualBus(const simulation::VirtualRigConfig& config, const RigProfile& profile)
      : profile_(profile), rig_(config, simulation::make_servo(config)) {}
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override {
    rig_.send(to, bytes, now);
  }
  std::vector<Chunk> advance(HostTime until) override {
    std::vector<Chunk> chunks = rig_.advance(until);
    std::erase_if(chunks, [&](const Chunk& chunk) { return !profile_.has(chunk.device); });
    return chunks;
  }

 private:
  RigProfile profile_;
  simulation::VirtualRig rig_;
};

}  // namespace

rig::RecordingResult record_virtual(const simulation::VirtualRigConfig& config, rig::VirtualOptions options) {
  VirtualBus bus(config, options.recording.profile);
  options.start = config.start;
  return rig::record_virtual(bus, options);
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "run_recording.h"

#include <utility>

#include "interrupts.h"
#include "thermorig/rig/recording/virtual_recording.h"
#include "thermorig/simulation/virtual_rig.h"

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

rig::RecordingResult run_recording(const ChosenRig& rig, bool in_virtual_time,
                                   const rig::PortOptions& options) {
  if (!in_virtual_time) return rig::record_ports(options);
  watch_interrupts();  // the first closes the recording; the second ends the program and leaves the journal
  VirtualBus bus(*rig.simulated, options.recording.profile);
  bool is_noticed = false;
  const auto stop_requested = [&] {
    if (!interrupted()) return false;
    if (!std::exchange(is_noticed, true) && options.notice) options.notice("stopping");
    return true;
  };
  return rig::record_virtual(bus, {.recording = options.recording,
                                   .start = rig.simulated->start,
                                   .stop_requested = stop_requested,
                                   .orders = options.orders,
                                   .progress = options.progress,
                                   .progress_period = options.progress_period});
}

}  // namespace thermorig::app

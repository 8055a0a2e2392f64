// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "served_port.h"
#include "thermorig/core/chunk.h"
#include "thermorig/io/device_side.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig {

/// The simulated rig behind three ports: what it sends goes to the programs, what they write goes to it. It
/// has no thread and waits for nothing: whoever calls serve() paces it, on the clock that was handed in.
class RigServer {
 public:
  using Clock = std::function<HostTime()>;

  /// `config.start` is ignored: the rig is switched on by switch_on().
  RigServer(const simulation::VirtualRigConfig& config, std::unique_ptr<simulation::Firmware> firmware,
            PerDevice<std::unique_ptr<io::DeviceSide>> sides, Clock now);

  /// Keeps what rig() and delivered() give; memory grows with time. Before switch_on().
  void keep_truth();

  /// Once, before serve().
  void switch_on();

  /// Runs the rig to the present and moves what there is, both ways. Throws Error(failed) when the
  /// micro-controller's process has died, with all ports unplugged.
  void serve();

  /// Of each port, to wait on for bytes of its program; -1 while none has it open.
  PerDevice<int> readable_fds() const;

  // From any thread. Plugs move with the next serve().
  void plug_in(Device device, std::unique_ptr<io::DeviceSide> side);
  void unplug(Device device);
  ServingTally tally() const;

  // While nothing is served.
  const simulation::VirtualRig& rig() const;
  const std::vector<std::uint8_t>& delivered(Device device) const;

 private:
  void serve_chunks();
  void deliver(const Chunk& chunk);
  void take_commands();
  void share_tally();
  void unplug_all();

  simulation::VirtualRigConfig config_;
  std::unique_ptr<simulation::Firmware> firmware_;  // until the rig takes it
  PerDevice<ServedPort> ports_;
  Clock now_;
  bool keeps_truth_ = false;
  std::unique_ptr<simulation::VirtualRig> rig_;
  HostTime serving_since_{};  // what the rig sent while it was being built is late by that, and by no fault
  double lag_sum_s_ = 0.0;
  ServingTally tally_;

  mutable std::mutex mutex_;  // of the shared tally
  ServingTally shared_tally_;
};

}  // namespace thermorig

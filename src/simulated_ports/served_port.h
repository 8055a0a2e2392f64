// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/io/port.h"
#include "thermorig/simulated_ports/simulated_ports.h"

namespace thermorig {

/// One pty with its tally. Used by the serving thread alone, except unplug().
class ServedPort {
 public:
  const std::string& path() const { return pty_.path(); }

  /// A descriptor to wait on for bytes of the program, -1 while no program has the port open.
  int readable_fd();

  void deliver(std::span<const std::uint8_t> bytes);
  std::vector<std::uint8_t> receive();

  void keep_delivered() { keeps_delivered_ = true; }
  const std::vector<std::uint8_t>& delivered() const { return delivered_; }

  /// From any thread: takes effect with the next call of readable_fd().
  void unplug() { unplug_ = true; }

  const PortTally& tally() const { return tally_; }

 private:
  io::Pty pty_;
  std::atomic<bool> unplug_ = false;
  PortTally tally_;
  bool keeps_delivered_ = false;
  std::vector<std::uint8_t> delivered_;
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/io/port.h"
#include "thermorig/simulated_ports/simulated_ports.h"

namespace thermorig {

/// One pty with its tally. Used by the serving thread alone, except unplug().
class ServedPort {
 public:
  /// Of the pseudo terminal that it had at first.
  const std::string& path() const { return pty_.path(); }

  /// A descriptor to wait on for bytes of the program, -1 while no program has the port open.
  int readable_fd();

  /// What finds no room waits for it, up to what the kernel keeps of a real port; the rest is lost.
  void deliver(std::span<const std::uint8_t> bytes);
  /// Delivers what waits, as far as there is room now. Call it often.
  void deliver_waiting();
  std::vector<std::uint8_t> receive();

  void keep_delivered() { keeps_delivered_ = true; }
  const std::vector<std::uint8_t>& delivered() const { return delivered_; }

  /// From any thread: takes effect with the next call of readable_fd().
  void unplug() { unplug_ = true; }

  /// From any thread, after unplug(): a new pseudo terminal, served from the next call of readable_fd() on.
  /// Returns its path.
  std::string plug_in();

  const PortTally& tally() const { return tally_; }

 private:
  std::size_t write(std::span<const std::uint8_t> bytes);

  io::Pty pty_;
  std::atomic<bool> unplug_ = false;
  std::mutex mutex_;  // of the next one
  std::optional<io::Pty> next_;
  PortTally tally_;
  std::vector<std::uint8_t> waiting_;
  bool keeps_delivered_ = false;
  std::vector<std::uint8_t> delivered_;
};

}  // namespace thermorig

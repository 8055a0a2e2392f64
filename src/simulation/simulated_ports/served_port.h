// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "thermorig/io/device_side.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig {

/// One simulated port with its tally, unplugged at first. Used by the serving thread alone, except plug_in().
class ServedPort {
 public:
  /// From any thread: takes effect with the next call of follow_plug(). None pulls the plug.
  void plug_in(std::unique_ptr<io::DeviceSide> next);
  void follow_plug();

  /// A descriptor to wait on for bytes of the program, -1 while no program has the port open.
  int readable_fd() const;

  /// What finds no room waits for it, up to what the kernel keeps of a real port; the rest is lost.
  void deliver(std::span<const std::uint8_t> bytes);
  /// Delivers what waits, as far as there is room now. Call it often.
  void deliver_waiting();
  std::vector<std::uint8_t> receive();

  void keep_delivered() { keeps_delivered_ = true; }
  const std::vector<std::uint8_t>& delivered() const { return delivered_; }

  const PortTally& tally() const { return tally_; }

  /// A program has opened it since the last call.
  bool was_opened();

 private:
  bool is_open() const { return side_ && side_->is_open(); }
  std::size_t write(std::span<const std::uint8_t> bytes);

  std::unique_ptr<io::DeviceSide> side_;  // none: unplugged
  std::mutex mutex_;                      // of the next one
  std::unique_ptr<io::DeviceSide> next_;
  bool changes_ = false;
  PortTally tally_;
  std::vector<std::uint8_t> waiting_;
  bool keeps_delivered_ = false;
  std::vector<std::uint8_t> delivered_;
  bool was_open_ = false;
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"

namespace thermorig::rig {

/// Asks cameras and gyros for their streams: when the port has opened, and again each second in which no
/// message came; those that send none, for one message more with each that came. What is said, the device's
/// protocol knows; many say nothing.
class StreamRequests {
 public:
  explicit StreamRequests(const RigProfile& profile) : profile_(profile) {}

  /// Its port is open anew: whatever it was asked, it may have forgotten.
  void port_opened(Device device) { streams_[device] = {}; }

  /// What is to be sent to a device whose port is open, mostly nothing. `messages`: heard of it so far;
  /// `refused`: answers of it that were none. They are asked for anew with the next message, so that one that
  /// has nothing but such answers is not asked without end.
  std::vector<std::uint8_t> due(Device device, std::uint64_t messages, HostTime now,
                                std::uint64_t refused = 0);

 private:
  struct Stream {
    std::optional<HostTime> since;  // it was asked, or a message came
    std::uint64_t messages = 0;
    std::uint64_t refused = 0;                       // when a message came last
    unsigned asked = 0;                              // in vain
    std::deque<std::vector<std::uint8_t>> commands;  // of the newest request, not yet sent
    HostTime next_command{};                         // not before
  };
  std::vector<std::uint8_t> asks_for(Device device, std::uint64_t messages) const;
  static std::vector<std::uint8_t> next_command(Stream& stream, HostTime now);

  RigProfile profile_;
  PerDevice<Stream> streams_;
};

}  // namespace thermorig::rig

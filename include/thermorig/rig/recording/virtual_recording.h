// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/device.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::rig {

/// A port that hung up, or that opened again.
struct PortChange {
  Device device = Device::camera;
  bool is_open = false;
};

/// Devices in virtual time: whoever has them in process (a simulated rig, a test) implements this.
struct DeviceBus {
  virtual ~DeviceBus() = default;
  /// Bytes from the host, written at `now` (not before the last advance()).
  virtual void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) = 0;
  /// Runs to `until`; chunks that arrive up to then, in order of arrival.
  virtual std::vector<Chunk> advance(HostTime until) = 0;
  /// What became of the ports since the last call, as of the last advance().
  virtual std::vector<PortChange> take_changes() { return {}; }
};

struct VirtualOptions {
  RecordingOptions recording;
  HostTime start{};                            // the bus was switched on then
  std::function<bool()> stop_requested;        // asked every step; may be empty
  std::function<std::vector<Order>()> orders;  // asked every step; may be empty
  ProgressHandler progress;                    // every period of virtual time; may be empty
  HostDuration progress_period = std::chrono::seconds(1);
};

/// A whole acquisition in virtual time, steps of 3 to 5 ms, then finalised. Deterministic if the bus is.
/// Throws as conclude() does.
RecordingResult record_virtual(DeviceBus& bus, const VirtualOptions& options);

}  // namespace thermorig::rig

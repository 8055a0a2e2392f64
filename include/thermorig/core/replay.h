// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/time.h"

namespace thermorig {

/// A device went away, and maybe came back: its clock before and after have nothing to do with each other.
struct Interruption {
  Device device = Device::camera;
  HostTime time{};
};

/// An event that says that a device went (`device_lost` or `missing`, with its source).
bool is_interruption(const RecordingEvent& event);

/// All of a recording, by its events, in order of time.
std::vector<Interruption> interruptions(const RawRecording& raw);

/// Bytes that came in one read(), or that went to a device in one write(); or a device that went away.
struct ReplayStep {
  std::optional<Device> from;  // none: they went to one
  std::optional<Device> to;
  std::span<const std::uint8_t> bytes;
  HostTime time{};               // of arrival; before write()
  bool is_interruption = false;  // of `from`: there are no bytes
};

/// Walks everything that a recording holds in the order in which it came: the one place that knows it.
/// Chunks of equal times go in the order of the devices, what was sent comes before what arrived, and a
/// device goes away after all that arrived by then.
class Replay {
 public:
  /// `raw` must outlive it.
  explicit Replay(const RawRecording& raw) : raw_(raw), interruptions_(interruptions(raw)) {}

  /// Nothing after the last chunk that arrived: what was sent after it was never answered.
  std::optional<ReplayStep> next();

 private:
  const RawRecording& raw_;
  std::vector<Interruption> interruptions_;
  std::size_t next_interruption_ = 0;
  PerDevice<std::size_t> next_received_{};
  PerDevice<std::size_t> next_sent_{};
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/virtual_recording.h"

namespace thermorig::rig {

namespace {

/// Steps of 3 to 5 ms: no host keeps the same phase to its USB frames for ever, and pings that did would
/// never see another one. The same in every recording. Knuth's MMIX generator, its upper bits.
class UnevenSteps {
 public:
  HostDuration next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return std::chrono::microseconds(3000 + (state_ >> 33U) % 2001U);
  }

 private:
  std::uint64_t state_ = 1;
};

}  // namespace

RecordingResult record_virtual(DeviceBus& bus, const VirtualOptions& options) {
  HostTime now = options.start;
  RecordingOptions recording_options = options.recording;
  recording_options.virtual_time = true;
  recording_options.sync_period = HostDuration::zero();
  Recording recording(recording_options, now,
                      [&](Device to, std::span<const std::uint8_t> bytes) { bus.send(to, bytes, now); });
  HostTime next_progress = now;
  UnevenSteps steps;
  while (!recording.done()) {
    now += steps.next();
    for (const Chunk& chunk : bus.advance(now)) recording.received(chunk.device, chunk.bytes, chunk.arrived);
    for (const PortChange& change : bus.take_changes())
      change.is_open ? recording.returned(change.device, now)
                     : recording.lost(change.device, "unplugged", now);
    if (options.stop_requested && options.stop_requested()) recording.request_stop(now);
    if (options.orders)
      for (const Order& order : options.orders()) recording.carry_out(order, now);
    recording.tick(now);
    if (!options.progress || now < next_progress) continue;
    options.progress(recording.progress(now));
    next_progress = now + options.progress_period;
  }
  if (options.progress) options.progress(recording.progress(now));
  return conclude(recording, now);
}

}  // namespace thermorig::rig

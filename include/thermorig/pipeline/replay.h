// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

/// A device went away, and maybe came back: its clock before and after have nothing to do with each other.
struct Interruption {
  Device device = Device::camera;
  HostTime time{};
};

/// An event that says that a device went (`device_lost` or `missing`, with its source).
bool is_interruption(const RecordingEvent& event);

/// All of a recording, in order of time: what its events tell.
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

/// The step into the pipeline, and the measurements that it completed.
std::vector<Measurement> feed(Pipeline& pipeline, const ReplayStep& step);

/// What a step of a replay brought.
struct ReplayMoment {
  HostTime time{};             // of the step; at the end that of the recording's end
  std::optional<Device> from;  // whose bytes they were; none: they went to the servo, or the recording ended
  Streams streams;             // decoded from them
  std::vector<Measurement> measurements;  // completed by them
};

/// A recording again as it was while it was made: step by step, through a pipeline without fits. Measurements
/// and their times are those of the recording, bit for bit: the last ones included that came when it was
/// closed, and those that stood in for a camera that had gone.
class CausalReplay {
 public:
  /// `raw` must outlive it.
  explicit CausalReplay(const RawRecording& raw);

  /// Nothing after the end.
  std::optional<ReplayMoment> next();

  const wire::Counters& counters(Device device) const { return pipeline_.counters(device); }

 private:
  HostTime end_time_;
  Replay replay_;
  Pipeline pipeline_;
  std::optional<HostTime> camera_gone_;  // not yet, or never: it has still to be stood in for
  bool ended_ = false;
};

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "thermorig/pipeline/frame_pairs.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/replay.h"

namespace thermorig::pipeline {

/// What a step of a replay brought.
struct ReplayMoment {
  HostTime time{};             // of the step; at the end that of the recording's end
  std::optional<Device> from;  // whose bytes they were; none: they went to the servo, or the recording ended
  Streams streams;             // decoded from them, but the frames, which come with their samples:
  std::vector<FramePair> pairs;
};

/// A recording again as it was while it was made: step by step, through a pipeline without fits. Pairs and
/// their times are those of the recording, bit for bit, the last ones included that came when it was closed.
class CausalReplay {
 public:
  /// `raw` must outlive it.
  explicit CausalReplay(const RawRecording& raw);

  /// Nothing after the end.
  std::optional<ReplayMoment> next();

  const wire::Counters& counters(Device device) const { return pipeline_.counters(device); }

 private:
  ReplayMoment moment(HostTime time, std::optional<Device> from, const std::vector<LabelledSample>& samples);

  HostTime end_time_;
  Replay replay_;
  Pipeline pipeline_;
  FramePairs pairs_;
  bool ended_ = false;
};

}  // namespace thermorig::pipeline

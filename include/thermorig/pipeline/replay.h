// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "thermorig/core/replay.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

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

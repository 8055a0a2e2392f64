// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/pipeline/causal_replay.h"
#include "thermorig/rig/absent_camera.h"

namespace thermorig::rig {

/// A live run again: the same frames and samples, at the same times, as its observer was told of, those
/// included that stood for a camera that had gone.
class LiveReplay {
 public:
  /// `raw` must outlive it.
  explicit LiveReplay(const RawRecording& raw);

  /// Nothing after the end. `pairs` of the moment are what an observer is told of at its time.
  std::optional<pipeline::ReplayMoment> next();

  const wire::Counters& counters(Device device) const { return replay_.counters(device); }

 private:
  std::optional<HostTime> camera_gone() const;
  void stand_in(pipeline::ReplayMoment& moment);

  const RawRecording& raw_;
  pipeline::CausalReplay replay_;
  std::optional<HostTime> gone_;
  std::optional<pipeline::ReplayMoment> coming_;  // none: the last one was the end
  std::optional<AbsentCamera> absent_camera_;
  std::uint64_t pairs_seen_ = 0;
};

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::app {

/// Where a replay stands, in the words of a recording.
class ReplayProgress {
 public:
  explicit ReplayProgress(const RawRecording& raw) : raw_(raw) {}

  void add(const pipeline::ReplayMoment& moment);
  void add(const LabelledSample& sample);

  /// With the events since the last call.
  rig::RecordingProgress at(HostTime now, const pipeline::CausalReplay& replay);

 private:
  std::vector<RecordingEvent> take_events(HostTime now);
  void note_gone(const RecordingEvent& event);
  rig::SweepProgress sweep(HostTime now) const;

  const RawRecording& raw_;
  PerDevice<rig::RateMeter> meters_;
  PerDevice<std::optional<float>> uncertainty_s_;
  std::uint64_t missing_frames_ = 0;
  std::optional<LabelledSample> last_sample_;
  int frames_in_leg_ = 0;
  PerDevice<bool> gone_{};
  std::size_t events_taken_ = 0;
};

}  // namespace thermorig::app

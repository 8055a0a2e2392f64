// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/pipeline/final_times.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/labels/frame_gaps.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::pipeline {

/// Camera bytes to frames with their time and exposure.
class CameraDecoder {
 public:
  CameraDecoder(const CameraProfile& profile, const Fits& fits);

  /// Appends the frames that the chunk completes to `out` and returns them.
  std::span<const TimedFrame> push(std::span<const std::uint8_t> chunk, HostTime arrived,
                                   std::vector<TimedFrame>& out);

  /// The stream has ended: the frames that waited for the bytes behind them.
  std::span<const TimedFrame> finish(std::vector<TimedFrame>& out);

  /// The camera is away: what it sends from here on, if it comes back, is another stream of a clock anew.
  /// Returns the frames that waited.
  std::span<const TimedFrame> interrupt(std::vector<TimedFrame>& out);

  const wire::Counters& counters() const { return scanner_.counters(); }

 private:
  std::span<const TimedFrame> take(std::vector<TimedFrame>& out);
  labels::FrameGap gap_before(const TimedFrame& frame, labels::HalvesWitness halves);
  labels::FrameGap gap_of_absence(const TimedFrame& frame);

  CameraProfile profile_;
  double period_s_;
  sensors::CameraScanner scanner_;
  timing::LinkTiming timing_;
  FinalTimes final_times_;
  labels::ExposureRule exposure_;
  std::vector<labels::FrameGap> known_gaps_;  // of a first pass; empty while recording
  labels::LiveFrameGaps live_gaps_;
  std::optional<unsigned> newer_half_;
  std::size_t frames_since_ = 0;  // the stream began, or the camera came back
  std::optional<HostTime> last_frame_;
  bool was_away_ = false;  // since the last frame
  std::size_t frame_count_ = 0;
  std::vector<wire::CameraMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline

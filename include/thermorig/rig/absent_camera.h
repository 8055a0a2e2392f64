// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/labels/labeller.h"
#include "thermorig/pipeline/frame_pairs.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::rig {

/// Stands in for a camera that is not there: a frame without an image each nominal frame period, so that a
/// sweep goes on by time and the gyro is still compared with the servo. Pure: the same streams at the same
/// times give the same rows, in a recording and in its replay.
class AbsentCamera {
 public:
  /// The camera has been missing since then. The first frame comes when all of those before have had their
  /// labels.
  AbsentCamera(const RigProfile& profile, HostTime since);

  /// What gyro and servo sent since, and the frames whose time has come, `before` real ones having been
  /// there. Of those that are due for longer than some seconds none is made: the next one says how many.
  void add(const pipeline::Streams& streams, HostTime now, std::uint64_t before);
  void finish();  // nothing more will come

  bool has_begun() const { return index_ > 0; }

  // What there is of them since the last call.
  std::vector<TimedFrame> take_frames();          // at once, for the sweep; its pixels mean nothing
  std::vector<pipeline::FramePair> take_pairs();  // later, with labels; every pixel is NaN

 private:
  std::int64_t leave_out(HostTime now);
  void pair(std::vector<LabelledSample> samples);

  HostDuration period_;
  HostTime next_end_;
  std::uint64_t before_ = 0;
  std::uint64_t index_ = 0;  // of the next frame, from 0
  labels::Labeller labeller_;
  pipeline::FramePairs pairs_;
  std::vector<TimedFrame> new_frames_;
};

}  // namespace thermorig::rig

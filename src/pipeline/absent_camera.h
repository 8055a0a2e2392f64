// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::pipeline {

/// Stands in for a camera that is missing: a frame without an image each nominal frame period, so that a
/// sweep goes on by time and the gyro is still compared with the servo.
class AbsentCamera {
 public:
  /// The camera has been missing since then. The first frame comes when all of those before have had their
  /// labels.
  AbsentCamera(double frame_rate_hz, HostTime since);

  /// Appends the frames whose time has come to `out` and returns them. Of those that are due for longer than
  /// some seconds none is made: the next one says how many.
  std::span<const TimedFrame> due(HostTime now, std::vector<TimedFrame>& out);

  bool has_begun() const { return has_begun_; }

 private:
  std::int64_t leave_out(HostTime now);

  HostDuration period_;
  HostTime next_end_;
  bool has_begun_ = false;
};

}  // namespace thermorig::pipeline

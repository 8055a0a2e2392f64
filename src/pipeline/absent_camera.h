// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::pipeline {

/// Stands in for a camera that is missing: a frame without an image each nominal frame period, so that a
/// sweep goes on by time and the gyro is still compared with the servo.
class AbsentCamera {
 public:
  /// The camera has been missing since then. The first frame comes when all of those before have had their
  /// labels, for which they wait a second at most.
  AbsentCamera(double frame_rate_hz, HostTime since)
      : period_(from_s(1.0 / std::min(frame_rate_hz, fastest_hz))),
        next_end_(since + std::chrono::milliseconds(1500) + period_) {}

  /// Appends the frames whose time has come to `out` and returns them. Of those that are due for longer than
  /// five seconds none is made: a host that slept, or a file that claims it, is not caught up with. The next
  /// one says how many.
  std::span<const TimedFrame> due(HostTime now, std::vector<TimedFrame>& out) {
    const std::size_t first = out.size();
    const HostDuration too_far = now - next_end_ - std::chrono::seconds(5);
    std::int64_t missing = std::max<std::int64_t>(too_far / period_, 0);
    next_end_ += missing * period_;
    for (; next_end_ <= now; next_end_ += period_) {
      // No run goes on over the gap.
      if (!std::exchange(has_begun_, true)) missing = std::max<std::int64_t>(missing, 1);
      TimedFrame& frame = out.emplace_back(frame_of(next_end_ - period_, next_end_));
      frame.missing_before = static_cast<std::uint16_t>(std::min(std::exchange(missing, 0), most_missing));
    }
    return std::span(out).subspan(first);
  }

  bool has_begun() const { return has_begun_; }

 private:
  static constexpr double fastest_hz = 64.0;  // of any camera, whatever a profile says
  static constexpr std::int64_t most_missing = std::numeric_limits<std::uint16_t>::max();

  static TimedFrame frame_of(HostTime begin, HostTime end) {
    TimedFrame frame;
    frame.stands_in = true;
    frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
    frame.frame.sensor_temp_c = std::numeric_limits<float>::quiet_NaN();
    frame.stamp.time = frame.stamp.arrival = end;
    frame.half = {HalfExposure{begin, end}, HalfExposure{begin, end}};
    frame.exposure_begin = begin;
    frame.exposure_end = end;
    return frame;
  }

  HostDuration period_;
  HostTime next_end_;
  bool has_begun_ = false;
};

}  // namespace thermorig::pipeline

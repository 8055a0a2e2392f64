// SPDX-License-Identifier: MIT
#include "absent_camera.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace thermorig::pipeline {

namespace {

constexpr auto last_labels = std::chrono::milliseconds(1500);  // a frame waits a second at most for its label
constexpr auto longest_catch_up = std::chrono::seconds(5);     // what lies further back is left out
constexpr double fastest_hz = 64.0;                            // of any camera, whatever a profile says
constexpr std::int64_t most_missing_frames = std::numeric_limits<std::uint16_t>::max();

TimedFrame frame_of(HostTime begin, HostTime end) {
  TimedFrame frame;
  frame.stands_in = true;
  frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  frame.frame.sensor_temp_c = std::numeric_limits<float>::quiet_NaN();
  frame.stamp.time = end;
  frame.stamp.arrival = end;
  frame.half = {HalfExposure{begin, end}, HalfExposure{begin, end}};
  frame.exposure_begin = begin;
  frame.exposure_end = end;
  return frame;
}

}  // namespace

AbsentCamera::AbsentCamera(double frame_rate_hz, HostTime since)
    : period_(from_s(1.0 / std::min(frame_rate_hz, fastest_hz))), next_end_(since + last_labels + period_) {}

std::span<const TimedFrame> AbsentCamera::due(HostTime now, std::vector<TimedFrame>& out) {
  const std::size_t first = out.size();
  std::int64_t missing = leave_out(now);
  for (; next_end_ <= now; next_end_ += period_) {
    // No run goes on over the gap.
    if (!std::exchange(has_begun_, true)) missing = std::max<std::int64_t>(missing, 1);
    TimedFrame& frame = out.emplace_back(frame_of(next_end_ - period_, next_end_));
    frame.missing_before =
        static_cast<std::uint16_t>(std::min(std::exchange(missing, 0), most_missing_frames));
  }
  return std::span(out).subspan(first);
}

/// A host that slept, or a file that claims it, is not caught up with. Returns how many frames are left out.
std::int64_t AbsentCamera::leave_out(HostTime now) {
  const HostDuration too_far = now - next_end_ - longest_catch_up;
  if (too_far <= HostDuration{}) return 0;
  const std::int64_t frames = too_far / period_;
  next_end_ += frames * period_;
  return frames;
}

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#include "thermorig/rig/absent_camera.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace thermorig::rig {

namespace {

constexpr auto last_labels = std::chrono::milliseconds(1500);  // a frame waits a second at most for its label
constexpr auto longest_catch_up = std::chrono::seconds(5);     // what lies further back is left out
constexpr double fastest_hz = 64.0;                            // of any camera, whatever a profile says
constexpr std::int64_t most_missing = std::numeric_limits<std::uint16_t>::max();
constexpr float any_temp_c = 20.0F;  // one that the label rules do not object to

TimedFrame frame_of(HostTime begin, HostTime end) {
  TimedFrame frame;
  frame.frame.temp_c.fill(any_temp_c);
  frame.frame.sensor_temp_c = any_temp_c;
  frame.stamp.time = end;
  frame.stamp.arrival = end;
  frame.half = {HalfExposure{begin, end}, HalfExposure{begin, end}};
  frame.exposure_begin = begin;
  frame.exposure_end = end;
  return frame;
}

}  // namespace

AbsentCamera::AbsentCamera(const RigProfile& profile, HostTime since)
    : period_(from_s(1.0 / std::min(profile.camera.output_rate_hz, fastest_hz))),
      next_end_(since + last_labels + period_),
      labeller_(labels::label_config(profile, {})) {}

void AbsentCamera::add(const pipeline::Streams& streams, HostTime now, std::uint64_t before) {
  for (const TimedGyro& gyro : streams.gyro) labeller_.add(gyro);
  for (const TimedServo& servo : streams.servo) labeller_.add(servo);
  std::int64_t missing = leave_out(now);
  for (; next_end_ <= now; next_end_ += period_) {
    if (index_++ == 0) {
      before_ = before;
      missing = std::max<std::int64_t>(missing, 1);  // no run goes on over the gap
    }
    TimedFrame frame = frame_of(next_end_ - period_, next_end_);
    frame.missing_before = static_cast<std::uint16_t>(std::min(std::exchange(missing, 0), most_missing));
    labeller_.add(frame);
    new_frames_.push_back(frame);
    frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());  // no network shall believe it
    pairs_.add({frame});
  }
  pair(labeller_.take(now));
}

/// A host that slept, or a file that claims it, is not caught up with. Returns how many frames are left out.
std::int64_t AbsentCamera::leave_out(HostTime now) {
  const HostDuration too_far = now - next_end_ - longest_catch_up;
  if (too_far <= HostDuration{}) return 0;
  const std::int64_t frames = too_far / period_;
  next_end_ += frames * period_;
  return frames;
}

void AbsentCamera::finish() {
  pair(labeller_.finish());
}

void AbsentCamera::pair(std::vector<LabelledSample> samples) {
  for (LabelledSample& sample : samples) sample.frame_index += static_cast<std::uint32_t>(before_);
  pairs_.add(samples);
}

std::vector<TimedFrame> AbsentCamera::take_frames() {
  return std::exchange(new_frames_, {});
}

std::vector<pipeline::FramePair> AbsentCamera::take_pairs() {
  return pairs_.take();
}

}  // namespace thermorig::rig

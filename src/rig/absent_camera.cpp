// SPDX-License-Identifier: MIT
#include "thermorig/rig/absent_camera.h"

#include <limits>
#include <utility>

namespace thermorig::rig {

namespace {

constexpr auto last_labels = std::chrono::milliseconds(1500);  // a frame waits a second at most for its label
constexpr float any_temp_c = 20.0F;                            // one that the label rules do not object to

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
    : period_(from_s(1.0 / profile.camera.output_rate_hz)),
      next_end_(since + last_labels + period_),
      labeller_(labels::label_config(profile, {})) {}

void AbsentCamera::add(const pipeline::Streams& streams, HostTime now, std::uint64_t before) {
  for (const TimedGyro& gyro : streams.gyro) labeller_.add(gyro);
  for (const TimedServo& servo : streams.servo) labeller_.add(servo);
  for (; next_end_ <= now; next_end_ += period_) {
    if (index_++ == 0) before_ = before;
    TimedFrame frame = frame_of(next_end_ - period_, next_end_);
    if (index_ == 1) frame.missing_before = 1;  // no run goes on over the gap
    labeller_.add(frame);
    new_frames_.push_back(frame);
    frame.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());  // no network shall believe it
    pairs_.add({frame});
  }
  pair(labeller_.take(now));
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

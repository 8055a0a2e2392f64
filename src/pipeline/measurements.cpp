// SPDX-License-Identifier: MIT
#include "measurements.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace thermorig::pipeline {

namespace {

constexpr std::size_t most_waiting = std::size_t{1} << 20;

template <typename Sample>
void keep(std::deque<Sample>& waiting, const Sample& sample) {
  waiting.push_back(sample);
  if (waiting.size() <= most_waiting) return;
  waiting.pop_front();
  waiting.front().lost_before = true;
}

template <typename Sample>
std::vector<Sample> take_until(HostTime end, std::deque<Sample>& waiting) {
  const auto later = std::find_if(waiting.begin(), waiting.end(),
                                  [end](const Sample& sample) { return sample.stamp.time > end; });
  std::vector<Sample> taken(waiting.begin(), later);
  waiting.erase(waiting.begin(), later);
  return taken;
}

}  // namespace

void Measurements::add(const TimedGyro& sample) {
  keep(gyro_, sample);
}

void Measurements::add(const TimedServo& state) {
  keep(servo_, state);
}

std::vector<Measurement> Measurements::with(const std::vector<LabelledSample>& labels) {
  assert(labels.size() <= frames_.size());
  std::vector<Measurement> measurements;
  measurements.reserve(labels.size());
  for (const LabelledSample& label : labels) {
    const TimedFrame& frame = frames_.front();
    measurements.push_back({.frame = frame,
                            .sample = label,
                            .gyro = take_until(frame.exposure_end, gyro_),
                            .servo = take_until(frame.exposure_end, servo_)});
    frames_.pop_front();
  }
  return measurements;
}

}  // namespace thermorig::pipeline

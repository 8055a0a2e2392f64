// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <deque>
#include <vector>

#include "thermorig/core/measurement.h"

namespace thermorig::pipeline {

/// Keeps what was measured until the frame that it belongs to has its label. Gyro and servo wait without a
/// frame as long as no camera sends one: of each the newest 2^20 are kept, more than an hour of the fastest.
class Measurements {
 public:
  void add(const TimedFrame& frame) { frames_.push_back(frame); }
  void add(const TimedGyro& sample) { keep(gyro_, sample); }
  void add(const TimedServo& state) { keep(servo_, state); }

  /// The labels of the frames that have waited longest, in the frames' order.
  std::vector<Measurement> with(const std::vector<LabelledSample>& labels) {
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

 private:
  static constexpr std::size_t most_waiting = std::size_t{1} << 20;

  template <typename Sample>
  static void keep(std::deque<Sample>& waiting, const Sample& sample) {
    waiting.push_back(sample);
    if (waiting.size() <= most_waiting) return;
    waiting.pop_front();
    waiting.front().lost_before = true;
  }

  template <typename Sample>
  static std::vector<Sample> take_until(HostTime end, std::deque<Sample>& waiting) {
    const auto later = std::find_if(waiting.begin(), waiting.end(),
                                    [end](const Sample& sample) { return sample.stamp.time > end; });
    std::vector<Sample> taken(waiting.begin(), later);
    waiting.erase(waiting.begin(), later);
    return taken;
  }

  std::deque<TimedFrame> frames_;
  std::deque<TimedGyro> gyro_;
  std::deque<TimedServo> servo_;
};

}  // namespace thermorig::pipeline

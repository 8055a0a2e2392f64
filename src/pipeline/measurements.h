// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <vector>

#include "thermorig/core/measurement.h"

namespace thermorig::pipeline {

/// Keeps what was measured until the frame that it belongs to has its label. Gyro and servo wait without a
/// frame as long as no camera sends one: of each the newest 2^20 are kept, more than an hour of the fastest.
class Measurements {
 public:
  void add(const TimedFrame& frame) { frames_.push_back(frame); }
  void add(const TimedGyro& sample);
  void add(const TimedServo& state);

  /// The labels of the frames that have waited longest, in the frames' order.
  std::vector<Measurement> with(const std::vector<LabelledSample>& labels);

 private:
  std::deque<TimedFrame> frames_;
  std::deque<TimedGyro> gyro_;
  std::deque<TimedServo> servo_;
};

}  // namespace thermorig::pipeline

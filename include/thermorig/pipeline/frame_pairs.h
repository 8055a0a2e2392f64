// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/sample.h"

namespace thermorig::pipeline {

/// A frame and the sample that the pipeline made of it.
struct FramePair {
  TimedFrame frame;
  LabelledSample sample;
};

/// Brings frames together with their samples, which come in the same order but later.
class FramePairs {
 public:
  void add(std::vector<TimedFrame> frames);
  void add(const std::vector<LabelledSample>& samples);
  std::vector<FramePair> take();  // complete ones, in order

 private:
  std::deque<TimedFrame> frames_;
  std::deque<LabelledSample> samples_;
};

}  // namespace thermorig::pipeline

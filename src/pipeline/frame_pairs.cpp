// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/frame_pairs.h"

namespace thermorig::pipeline {

void FramePairs::add(std::vector<TimedFrame> frames) {
  for (const TimedFrame& frame : frames) frames_.push_back(frame);
}

void FramePairs::add(const std::vector<LabelledSample>& samples) {
  samples_.insert(samples_.end(), samples.begin(), samples.end());
}

std::vector<FramePair> FramePairs::take() {
  std::vector<FramePair> pairs;
  while (!frames_.empty() && !samples_.empty()) {
    pairs.push_back({frames_.front(), samples_.front()});
    frames_.pop_front();
    samples_.pop_front();
  }
  return pairs;
}

}  // namespace thermorig::pipeline

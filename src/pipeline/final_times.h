// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::pipeline {

/// The stamp's time and bounds become those of the estimate.
inline void put(const TimeEstimate& estimate, Stamp& stamp) {
  stamp.time = estimate.time;
  stamp.uncertainty_s = estimate.uncertainty_s;
  stamp.earlier_s = estimate.earlier_s;
  stamp.later_s = estimate.later_s;
}

/// What a link's timing gets as its messages' nominal rate: 0, so that it follows no clock, where each
/// message has its final time anyway.
inline double causal_rate_hz(const std::vector<TimeEstimate>& final_times, double rate_hz) {
  return final_times.empty() ? rate_hz : 0.0;
}

/// The times that a first pass found for the messages of one device, handed out in their order. Without
/// them, or beyond them, the causal stamps stand.
class FinalTimes {
 public:
  explicit FinalTimes(std::vector<TimeEstimate> times) : times_(std::move(times)) {}

  /// The next message's stamp gets its final time. False: there is none.
  bool put_next(Stamp& stamp) {
    if (next_ >= times_.size()) return false;
    put(times_[next_++], stamp);
    return true;
  }

 private:
  std::vector<TimeEstimate> times_;
  std::size_t next_ = 0;
};

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
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

/// A servo's clock, a resonator or the oscillator of a controller, is no further off, as a share.
inline constexpr double most_clock_off = 0.03;

/// Seconds of the host's clock for each microsecond of the servo's, by two messages of telemetry, one after
/// the other. Where a reset or an absence lies between them, as many as there should be.
inline double host_s_per_us(const TimedServo& before, const TimedServo& now) {
  const auto us = static_cast<double>(now.mcu_time_us - before.mcu_time_us);
  const double share = us > 0.0 ? to_s(now.stamp.time - before.stamp.time) / (us * 1e-6) : 0.0;
  return std::abs(share - 1.0) < most_clock_off ? share * 1e-6 : 1e-6;
}

}  // namespace thermorig::pipeline

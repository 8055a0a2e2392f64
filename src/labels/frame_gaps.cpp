// SPDX-License-Identifier: MIT
#include "thermorig/labels/frame_gaps.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::labels {

namespace {
constexpr double late_limit_periods = 0.8;  // without the halves' word, later than this is a missing frame
constexpr double schedule_gain = 0.1;       // how fast the schedule follows frames that are late
constexpr std::size_t least_intervals = 4;  // before a measured period is believed

/// The number nearest to `value` of the form first, first + 2, first + 4 ...
unsigned nearest_of_parity(double value, unsigned first) {
  return first + 2 * static_cast<unsigned>(std::lround(std::max(0.0, value - first) / 2.0));
}
}  // namespace

FrameGaps::FrameGaps(double frame_period_s, bool measured) : period_s_(frame_period_s), measured_(measured) {
  assert(frame_period_s > 0.0);
}

FrameGaps::Half FrameGaps::fresh_half(const TimedFrame& frame, CameraMode mode) {
  const Freshness freshness{.even = frame.fresh_even, .odd = frame.fresh_odd};
  if (mode != CameraMode::half_fresh || !freshness.one_fresh()) return Half::unknown;
  return freshness.even_fresh() ? Half::even : Half::odd;
}

unsigned FrameGaps::missing(double late_periods, Half half) const {
  if (half != Half::unknown && half_before_ != Half::unknown)
    return nearest_of_parity(late_periods, half == half_before_ ? 1 : 0);
  return late_periods > late_limit_periods ? static_cast<unsigned>(std::lround(late_periods)) : 0;
}

/// The median of the last intervals: a late read or a missing frame among them does not move it.
void FrameGaps::learn_period(HostTime time) {
  intervals_s_[interval_count_++ % kept_intervals] = to_s(time - *before_);
  if (measured_ || interval_count_ < least_intervals) return;
  const std::size_t count = std::min(interval_count_, kept_intervals);
  std::array<double, kept_intervals> sorted = intervals_s_;
  std::nth_element(sorted.begin(), sorted.begin() + count / 2, sorted.begin() + count);
  if (sorted[count / 2] > 0.0) period_s_ = sorted[count / 2];
}

unsigned FrameGaps::push(const TimedFrame& frame, CameraMode mode) {
  const HostTime time = frame.stamp.time;
  const Half half = fresh_half(frame, mode);
  unsigned count = 0;
  if (before_) {
    learn_period(time);
    const double late_periods = to_s(time - expected_) / period_s_;
    count = missing(late_periods, half);
    const double rest = late_periods - count;
    expected_ = time - from_s((rest > 0.0 ? (1.0 - schedule_gain) * rest : 0.0) * period_s_);
  } else {
    expected_ = time;
  }
  expected_ += from_s(period_s_);
  before_ = time;
  half_before_ = half;
  return count;
}

}  // namespace thermorig::labels

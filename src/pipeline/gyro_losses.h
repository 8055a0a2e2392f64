// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::pipeline {

/// How many samples of a gyro never came, as well as can be told while it goes on sending: no gyro numbers
/// its samples. By the steps of its own time where it sends one, else by the clock that counts at its steady
/// rate. That clock takes back what only came late, so a loss counts when it has stood for some seconds.
class GyroLosses {
 public:
  /// The next sample. `counted`: samples missing so far by the clock, LinkTiming::missing().
  void sample(const TimedGyro& sample, double counted);

  /// The gyro is away, and its clock forgotten: what it does not send meanwhile is not lost.
  void interrupt();

  std::uint64_t count() const { return before_ + settled_; }

 private:
  void look_at_step(HostTime time, double own_s);
  double usual_step_s() const;
  void settle(HostTime now, double missing);

  static constexpr std::size_t kept_steps = 15;
  std::array<double, kept_steps> steps_s_{};  // of its own time, the last ones
  std::size_t step_count_ = 0;
  std::optional<double> own_s_;  // of the sample before
  HostTime time_{};              // of the sample before
  double own_missing_ = 0.0;
  std::optional<HostTime> span_begin_;  // of the span in which `least_` is the least that was missing
  double least_ = 0.0;
  std::uint64_t settled_ = 0;
  std::uint64_t before_ = 0;  // the gyro was away
};

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "sliding_fit.h"
#include "thermorig/core/profile.h"
#include "thermorig/pipeline/timing/arrivals.h"

namespace thermorig::timing {

/// One segment of a device's clock. Host times count in seconds from `origin`.
struct SegmentFit {
  std::vector<double> time_s;     // of each message: its first byte began
  std::vector<double> earlier_s;  // bounds about it
  std::vector<double> later_s;
  std::vector<double> uncertainty_s;
  std::vector<double> late_s;  // of each inequality
  std::vector<ClockKnot> knots;
  double slope = 1.0;  // host seconds a device second, mean
};

/// What is known of the device before its clock is fitted.
struct DeviceClock {
  SlidingWindow window;
  double step_s = 0.0;  // between messages, on its own clock
  double wander = 0.0;  // relative
  double largest_constant_delay_s = 0.0;
};

SegmentFit fit_segment(std::span<const double> device_s, std::span<const LatestBegin> latest,
                       const DeviceClock& device, HostTime origin);

}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ping_bounds.h"
#include "ping_hull.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sync.h"

namespace thermorig::timing {

/// How a servo's clock did, gathered epoch by epoch.
class PingReport {
 public:
  explicit PingReport(const PortProfile& link);

  void add(const ClockEpoch& epoch, const PingHull& hull, const ClockOrigin& origin);

  /// Of an epoch: what was needed to explain it, infinite where nothing does, and what its bounds allow for;
  /// 0: not checked.
  void add_wander(double needed, double checked);

  /// `mcu_us` and their `times`: rate, widths, gaps.
  ClockReport finish(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times, bool two_way);

 private:
  void add_knots(const PingHull& hull, const ClockOrigin& origin);
  void add_lateness(const PingHull& hull);
  void find_gaps(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times);
  void measure_widths(std::span<const TimeEstimate> times);

  PortProfile link_;
  ClockReport report_;
  double largest_needed_ = 0.0;  // wander
  double largest_checked_ = 0.0;
  bool is_checked_ = true;
  std::vector<float> late_s_;
};

}  // namespace thermorig::timing

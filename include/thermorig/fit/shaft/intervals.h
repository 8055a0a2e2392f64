// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/label_config.h"

namespace thermorig::fit {

using labels::constant_dps, labels::unknown_bias_dps;

/// A shaft follows a change of its speed within that.
inline constexpr double settled_after_s = 0.5;

/// Scatter of a median, by that of a mean.
inline constexpr double median_scatter = 1.25;

/// Part of a recording, in seconds from an origin.
struct Interval {
  double begin_s = 0.0;
  double end_s = 0.0;
  double rate_dps = 0.0;  // commanded
  std::uint16_t leg = 0;  // at its end; 0: none
};

/// Where telemetry without a gap reports one speed and no change of it. `rests`: the servo holds or is
/// disarmed; else it moves.
std::vector<Interval> steady_intervals(std::span<const TimedServo> servo, HostTime origin, bool rests);

/// Where the commanded speed changes, by telemetry without a longer gap: from the first to the last change of
/// a ramp.
std::vector<Interval> speed_changes(std::span<const TimedServo> servo, HostTime origin, double longest_gap_s);

}  // namespace thermorig::fit

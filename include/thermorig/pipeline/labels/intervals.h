// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::labels {

/// Commanded speeds that differ by less are the same one: telemetry counts centidegrees per second.
inline constexpr double constant_dps = 0.015;

/// Standard deviation of a bias that nothing tells.
inline constexpr double unknown_bias_dps = 20.0;

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

/// Where the commanded speed changes, by telemetry without a gap: from the first to the last change of a
/// ramp.
std::vector<Interval> speed_changes(std::span<const TimedServo> servo, HostTime origin);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig::simulation {

/// The host's monotonic clock against rig time, both in nanoseconds since the start: the same, or slewed as
/// a program does that sets the computer's time by others (adjtimex(2)): for half of every four minutes.
class HostClock {
 public:
  explicit HostClock(double slew_ppm) : slew_(1e-6 * slew_ppm) {}

  /// Rounded down, so that rig_ns(host_ns(t)) is never after t.
  std::int64_t host_ns(std::int64_t rig_ns) const;
  std::int64_t rig_ns(std::int64_t host_ns) const;

 private:
  double slew_;  // relative, while it lasts
};

}  // namespace thermorig::simulation

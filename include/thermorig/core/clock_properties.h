// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig {

/// What the clock of a device can do. It stands in the entry of the device's protocol.
struct ClockProperties {
  double tick_s = 0.0;           // of the time that each message carries; 0: messages carry no time
  std::uint64_t wrap_ticks = 0;  // after so many the time begins again; 0: it does not within years
  double rate_error_max = 0.1;   // as a share: a time that goes slower or faster than that is not its own

  bool sends_time() const { return tick_s > 0.0; }
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#pragma once

#include <cassert>
#include <chrono>

#include "thermorig/core/time.h"

namespace thermorig::io {

/// When the ticks of a timer are due: at whole periods after its begin. Those that are missed are left out,
/// not made up for.
class TickSchedule {
 public:
  TickSchedule() = default;
  /// `period` > 0.
  TickSchedule(HostDuration period, HostTime begin) : period_(period), due_(begin + period) {
    assert(period > HostDuration::zero());
  }

  HostTime due() const { return due_; }

  /// Whether a tick is due at `now`; if so, the next one is due at the first whole period after `now`.
  bool take(HostTime now) {
    if (now < due_) return false;
    due_ += ((now - due_) / period_ + 1) * period_;
    return true;
  }

 private:
  HostDuration period_ = std::chrono::seconds(1);
  HostTime due_{};
};

}  // namespace thermorig::io

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/core/sample.h"

namespace thermorig::odometer {

/// Tells a gyro that is frozen, or that sets itself to zero at rest, from one that lives: noise never repeats
/// itself for long.
class GyroWatch {
 public:
  void add(const TimedGyro& sample) {
    const bool repeats = has_last_ && sample.reading.rate_dps == last_.rate_dps;
    if (!repeats) since_ = sample.stamp.time;
    last_ = sample.reading;
    time_ = sample.stamp.time;
    has_last_ = true;
  }

  bool is_frozen() const { return has_last_ && time_ - since_ >= longest; }
  bool is_zero() const { return has_last_ && last_.is_zero(); }

 private:
  static constexpr HostDuration longest = std::chrono::milliseconds(300);
  GyroReading last_;
  HostTime since_{}, time_{};
  bool has_last_ = false;
};

}  // namespace thermorig::odometer

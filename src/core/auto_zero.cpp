// SPDX-License-Identifier: MIT
#include "thermorig/core/auto_zero.h"

#include <algorithm>
#include <cmath>

namespace thermorig {

namespace {
// The noise of a sample is 0.05 to 0.13 deg/s: in steps of 0.061 (16 bits over +-2000 deg/s) it moves the
// last bit every few samples, in steps of 0.1 it may not for fifty.
constexpr float coarsest_dps = 0.07F;
}  // namespace

bool RepeatedReading::add(const GyroReading& reading, HostTime time) {
  const bool repeats = last_ && reading.rate_dps == last_->rate_dps;
  if (!repeats) restart(time);
  if (repeats) ++repeats_;
  last_ = reading;
  time_ = time;
  return repeats;
}

void AutoZero::add(const GyroReading& reading) {
  const std::array<float, 3>& rate_dps = reading.rate_dps;
  for (std::size_t axis = 0; axis < rate_dps.size(); ++axis) {
    const float step_dps = std::abs(rate_dps[axis] - last_dps_[axis]);
    if (step_dps > 0.0F) resolution_dps_ = std::min(resolution_dps_, step_dps);
  }
  last_dps_ = rate_dps;
  zeros_ = reading.is_zero() ? zeros_ + 1 : 0;
  longest_ = std::max(longest_, zeros_);
}

bool AutoZero::is_coarse() const {
  return std::isfinite(resolution_dps_) && resolution_dps_ > coarsest_dps;
}

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/mcu_time.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::timing {

McuTime::McuTime(const ClockProperties& clock)
    : wrap_us_(std::llround(static_cast<double>(clock.wrap_ticks) * clock.tick_s * 1e6)),
      rate_error_max_(clock.rate_error_max) {
  assert(wrap_us_ > 0);
}

/// Microseconds from `before` to `now` with as many wraps as fit the host's clock, or nothing if none fits.
std::optional<std::int64_t> McuTime::advance_us(std::uint32_t before, std::uint32_t now,
                                                double host_us) const {
  const auto wrap_us = static_cast<double>(wrap_us_);
  const std::int64_t step_us = std::int64_t{now} - before;
  const auto least_us = static_cast<double>(step_us < 0 ? step_us + wrap_us_ : step_us);
  const double wraps = std::max(0.0, std::round((host_us - least_us) / wrap_us));
  const double advance = least_us + wraps * wrap_us;
  const double tolerance_us = tolerance_s * 1e6 + rate_error_max_ * host_us;
  if (std::abs(advance - host_us) > tolerance_us) return std::nullopt;
  return static_cast<std::int64_t>(advance);
}

std::int64_t McuTime::unwrap(std::uint32_t mcu_us, HostTime at) {
  std::int64_t unwrapped_us = restarted_us_ + mcu_us;
  if (last_) {
    const auto advance = advance_us(last_->mcu_us, mcu_us, to_s(at - last_->at) * 1e6);
    if (advance) unwrapped_us = last_->unwrapped_us + *advance;
  }
  last_ = Seen{mcu_us, unwrapped_us, at};
  return unwrapped_us;
}

void McuTime::restart() {
  if (!last_) return;
  restarted_us_ = (last_->unwrapped_us / wrap_us_ + 2) * wrap_us_;
  last_.reset();
}

}  // namespace thermorig::timing

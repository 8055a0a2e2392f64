// SPDX-License-Identifier: MIT
#include "thermorig/timing/mcu_time.h"

#include <algorithm>
#include <cmath>

namespace thermorig::timing {

namespace {
constexpr double wrap_us = 4294967296.0;  // 2^32
constexpr double clock_error_share =
    0.02;  // a ceramic resonator is within 0.5 %, an RC oscillator within 2 %

/// Microseconds from `before` to `now` with as many wraps as fit the host's clock, or nothing if none fits.
std::optional<std::int64_t> advance_us(std::uint32_t before, std::uint32_t now, double host_us) {
  const double least_us = now - before;  // modulo 2^32
  const double wraps = std::max(0.0, std::round((host_us - least_us) / wrap_us));
  const double advance = least_us + wraps * wrap_us;
  const double tolerance_us = McuTime::tolerance_s * 1e6 + clock_error_share * host_us;
  if (std::abs(advance - host_us) > tolerance_us) return std::nullopt;
  return static_cast<std::int64_t>(advance);
}
}  // namespace

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
  constexpr std::int64_t wrap = std::int64_t{1} << 32U;
  restarted_us_ = (last_->unwrapped_us / wrap + 2) * wrap;
  last_.reset();
}

}  // namespace thermorig::timing

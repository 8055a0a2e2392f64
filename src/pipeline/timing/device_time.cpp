// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/device_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "thermorig/core/statistics.h"

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

namespace {
constexpr double counter_of_32_bits = 4294967296.0;
constexpr std::array<double, 3> wraps_s{1e-6 * counter_of_32_bits, 1e-4 * counter_of_32_bits,
                                        1e-3 * counter_of_32_bits};
constexpr std::size_t fewest_times = 32;
constexpr std::size_t lags = 4;       // a reset, an outage, a torn line spoil the fewer of steps that long
constexpr double late_reads_s = 0.3;  // a reader on a busy host stalls for less
constexpr double short_step = 0.5;    // of a message's share of the time: no loss makes a step short
constexpr double most_short_steps = 0.1;  // whatever jitter a device's own rhythm has
constexpr double fewest_due = 0.5;        // below it most messages lack, and long steps are usual
}  // namespace

double UnwrappedTime::unwrap_s(std::int64_t device_us, HostTime arrived) {
  if (last_ && device_us < last_->device_us) {
    const double back_s = 1e-6 * (static_cast<double>(last_->device_us) - static_cast<double>(device_us));
    const double host_s = to_s(arrived - last_->arrived);
    for (const double wrap_s : wraps_s)
      if (wrap_s > back_s && std::abs(wrap_s - back_s - host_s) <= McuTime::tolerance_s) wrapped_s_ += wrap_s;
  }
  last_ = Seen{device_us, arrived};
  return wrapped_s_ + 1e-6 * static_cast<double>(device_us);
}

std::string why_no_sample_times(std::span<const OwnStamp> times, double nominal_rate_hz,
                                double rate_error_max) {
  if (!(nominal_rate_hz > 0.0) || times.size() < fewest_times) return "";
  const std::size_t lag = times.size() / lags;
  std::vector<double> own_steps_s, host_steps_s;
  for (std::size_t i = lag; i < times.size(); ++i) {
    own_steps_s.push_back(times[i].own_s - times[i - lag].own_s);
    host_steps_s.push_back(to_s(times[i].arrived - times[i - lag].arrived));
  }
  const double own_s = median(std::move(own_steps_s));
  const double host_s = median(std::move(host_steps_s));
  if (std::abs(own_s - host_s) > rate_error_max * host_s + late_reads_s)
    return fmt::format("they go on by {:.4g} s in {:.4g} s", own_s, host_s);
  const double share_s = own_s / static_cast<double>(lag);
  if (share_s * nominal_rate_hz * fewest_due > 1.0) return "";
  double short_steps = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double step_s = times[i].own_s - times[i - 1].own_s;
    if (step_s >= 0.0 && step_s < short_step * share_s) short_steps += 1.0;
  }
  const auto count = static_cast<double>(times.size() - 1);
  if (short_steps <= most_short_steps * count) return "";
  return fmt::format(
      "{:.0f} % of them follow the one before at once, yet {:.4g} samples come a second: they tell when "
      "several "
      "were read or printed",
      100.0 * short_steps / count, 1.0 / share_s);
}

std::optional<double> OwnClock::place_s(const std::optional<std::int64_t>& device_us, HostTime arrived) {
  if (!device_us || is_unused_) return std::nullopt;
  const double own_s = unwrapped_.unwrap_s(*device_us, arrived);
  times_.push_back({own_s, arrived});
  if (++new_ < looked_at) return own_s;
  new_ = 0;
  if (times_.size() > kept) times_.erase(times_.begin(), times_.end() - kept);
  is_unused_ = !why_no_sample_times(times_, nominal_rate_hz_, rate_error_max_).empty();
  return is_unused_ ? std::nullopt : std::optional(own_s);
}

}  // namespace thermorig::timing

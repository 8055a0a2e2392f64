// SPDX-License-Identifier: MIT
#include "ping_report.h"

#include <algorithm>
#include <cmath>

#include "clock_summary.h"
#include "ping_epochs.h"
#include "thermorig/core/statistics.h"

namespace thermorig::timing {
PingReport::PingReport(const PortProfile& link) : link_(link) {
  report_.largest_constant_delay_s = link.largest_constant_delay_s;
}

void PingReport::add(const ClockEpoch& epoch, const PingHull& hull, const ClockOrigin& origin) {
  report_.epochs.push_back(epoch);
  for (const PingHull::Break& a_break : hull.breaks()) {
    const double mcu_s = hull.events()[a_break.event].mcu_s;
    const Range& offset = hull.offsets()[a_break.event];
    const double known = std::isfinite(offset.hi) ? offset.hi : offset.lo;
    report_.epochs.push_back({origin.time(mcu_s, known), contradiction_reason(a_break.missed_s, link_)});
  }
  add_knots(hull, origin);
  add_lateness(hull);
}

void PingReport::add_knots(const PingHull& hull, const ClockOrigin& origin) {
  for (std::size_t k = 0; k < hull.knots().size(); ++k) {
    const std::size_t event = hull.knots()[k];
    const Range& offset = hull.offsets()[event];
    if (!std::isfinite(offset.width())) continue;
    const double middle_s = (offset.lo + offset.hi) / 2;
    const HostTime time = origin.time(hull.events()[event].mcu_s, middle_s);
    const double since_boot_s = hull.events()[event].mcu_s + seconds_between(0, origin.mcu_us);
    report_.knots.push_back({.time = time,
                             .offset_s = seconds_between(HostTime{}, time) - since_boot_s,
                             .skew_ppm = hull.rate_at(k) * 1e6,
                             .residual_us = offset.width() / 2 * 1e6});
  }
}

void PingReport::add_lateness(const PingHull& hull) {
  for (std::size_t i = 0; i < hull.events().size(); ++i) {
    const double given_s = hull.events()[i].given.hi;
    const Range& offset = hull.offsets()[i];
    if (std::isfinite(given_s) && std::isfinite(offset.width()))
      late_s_.push_back(static_cast<float>(given_s - (offset.lo + offset.hi) / 2));
  }
}

void PingReport::add_wander(double needed, double checked) {
  largest_needed_ = std::max(largest_needed_, needed);
  is_checked_ = is_checked_ && checked > 0.0;
  largest_checked_ = std::max(largest_checked_, checked);
}

void PingReport::find_gaps(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times) {
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < mcu_us.size(); ++i)
    if (mcu_us[i] > mcu_us[i - 1]) periods_s.push_back(seconds_between(mcu_us[i - 1], mcu_us[i]));
  if (periods_s.empty()) return;
  const double period_s = lower_quantile(periods_s, 0.5);
  report_.rate_hz = 1.0 / period_s;
  for (std::size_t i = 1; i < mcu_us.size(); ++i) {
    const double missing = std::round(seconds_between(mcu_us[i - 1], mcu_us[i]) / period_s) - 1.0;
    if (missing >= 1.0 && missing < 1e9)
      report_.gaps.push_back({times[i - 1].time, times[i].time, static_cast<std::uint64_t>(missing)});
  }
}

void PingReport::measure_widths(std::span<const TimeEstimate> times) {
  std::vector<float> widths_s;
  for (const TimeEstimate& time : times)
    if (std::isfinite(time.earlier_s)) widths_s.push_back(time.earlier_s + time.later_s);
  if (widths_s.empty()) return;
  report_.bound_us = static_cast<double>(*std::max_element(widths_s.begin(), widths_s.end())) * 1e6;
  report_.bound_median_us = double{lower_quantile(widths_s, 0.5)} * 1e6;
  report_.uncertainty_us = report_.bound_median_us / std::sqrt(12.0);
}

ClockReport PingReport::finish(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times,
                               bool two_way) {
  report_.method = two_way ? "two-way" : "one-way";
  report_.needed_wander_ppm = 1e6 * largest_needed_;
  report_.bound_wander_ppm = is_checked_ ? 1e6 * largest_checked_ : 0.0;
  find_gaps(mcu_us, times);
  measure_widths(times);
  if (mcu_us.size() > 1) summarise_skew(report_);
  summarise_lateness(late_s_, report_);
  return std::move(report_);
}

}  // namespace thermorig::timing

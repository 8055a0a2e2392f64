// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/ping_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/statistics.h"

namespace thermorig::timing {
namespace {

constexpr double knot_period_s = 1.0;

constexpr double longest_s = 4e9;  // within the range of the host's clock

constexpr double stamp_tick_s = 1e-6 * static_cast<double>(stamp_tick_us);

float outward(double seconds) {
  return std::nextafter(static_cast<float>(seconds), std::numeric_limits<float>::infinity());
}

}  // namespace

double wander_reach_s(double span_s, double wander) {
  return wander * span_s * std::max(1.0, span_s / rate_window_s);
}

double seconds_between(HostTime before, HostTime later) {
  return seconds_between(to_ns(before), to_ns(later)) * 1e-3;
}

double seconds_between(std::int64_t before_us, std::int64_t later_us) {
  const auto difference = static_cast<std::uint64_t>(later_us) - static_cast<std::uint64_t>(before_us);
  return static_cast<double>(static_cast<std::int64_t>(difference)) * 1e-6;
}

Range rate_aside(const Range& mean, double aside_s, double drift, double unseen_s) {
  const double bow = 8.0 * unseen_s * std::abs(aside_s) / (rate_window_s * rate_window_s);
  const double drifted = drift * aside_s;
  return {mean.lo - bow + std::min(drifted, 0.0), mean.hi + bow + std::max(drifted, 0.0)};
}

double median_width_s(std::span<const Range> offsets) {
  std::vector<double> widths_s;
  for (const Range& offset : offsets)
    if (std::isfinite(offset.width())) widths_s.push_back(offset.width());
  return widths_s.empty() ? 0.0 : lower_quantile(widths_s, 0.5);
}

Range lower_bound(const PingBound& bound, const ClockOrigin& origin) {
  return {origin.offset_s(bound.receive_us, bound.not_before) - stamp_tick_s, unbounded};
}

Range upper_bound(const PingBound& bound, const ClockOrigin& origin) {
  return {-unbounded, origin.offset_s(bound.send_us, bound.not_after)};
}

double wander_of(const PortProfile& link) {
  return std::isfinite(link.wander_ppm) ? std::abs(link.wander_ppm) * 1e-6 : max_rate;
}

TimeEstimate within(TimeEstimate likely, const TimeEstimate& sure) {
  const auto ahead_s = static_cast<float>(seconds_between(likely.time, sure.time));
  likely.earlier_s = std::max(likely.earlier_s, sure.earlier_s - ahead_s);
  likely.later_s = std::max(likely.later_s, sure.later_s + ahead_s);
  return likely;
}

HostTime ClockOrigin::time(double mcu_at_s, double offset_s) const {
  const double since_s = std::clamp(mcu_at_s + offset_s, -longest_s, longest_s);
  const auto since_ns = static_cast<std::uint64_t>(from_s(since_s).count());
  return host_time_ns(static_cast<std::int64_t>(static_cast<std::uint64_t>(to_ns(host)) + since_ns));
}

TimeEstimate ClockOrigin::estimate(double mcu_at_s, const Range& offset) const {
  const double middle_s = (offset.lo + offset.hi) / 2;
  const double half_s = (offset.hi - offset.lo) / 2;
  return {.time = time(mcu_at_s, middle_s),
          .uncertainty_s = static_cast<float>(half_s / std::sqrt(3.0)),
          .earlier_s = outward(half_s + 1e-9),
          .later_s = outward(half_s + 1e-9)};
}

PingBounds::PingBounds(const PingBound& first, double wander, RateNow rate_now)
    : wander_(wander),
      rate_now_(rate_now),
      origin_{first.not_after, first.send_us},
      newest_us_(first.send_us) {
  knots_.push_back(newest_);
  take(first);
}

Range PingBounds::onward(const Knot& from, double mcu_s) const {
  const double span_s = mcu_s - from.mcu_s;
  const double reach_s = wander_reach_s(span_s, wander_);
  return {from.offset.lo + rate_.lo * span_s - reach_s, from.offset.hi + rate_.hi * span_s + reach_s};
}

Range PingBounds::backward(const Knot& from, double mcu_s) const {
  const double span_s = from.mcu_s - mcu_s;
  const double reach_s = wander_reach_s(span_s, wander_);
  return {from.offset.lo - rate_.hi * span_s - reach_s, from.offset.hi - rate_.lo * span_s + reach_s};
}

Range PingBounds::at(double mcu_s) const {
  if (mcu_s >= newest_.mcu_s) return onward(newest_, mcu_s);
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), mcu_s,
                                      [](double at_s, const Knot& knot) { return at_s < knot.mcu_s; });
  Range range = backward(after == knots_.end() ? newest_ : *after, mcu_s);
  if (after == knots_.begin()) return range;
  const Range from_before = onward(*std::prev(after), mcu_s);
  return {std::max(range.lo, from_before.lo), std::min(range.hi, from_before.hi)};
}

PingFate PingBounds::fate(const PingBound& bound) const {
  const double send_s = origin_.mcu_s(bound.send_us);
  if (send_s < newest_.mcu_s - order_tolerance_s) return PingFate::went_back;
  if (bound.two_sided) {
    const double held_s = seconds_between(bound.receive_us, bound.send_us);
    const double away_s = seconds_between(bound.not_before, bound.not_after);
    if (away_s < held_s * (1.0 - max_rate) - rounding_s - stamp_tick_s) return PingFate::faster_than_wire;
    const double receive_s = origin_.mcu_s(bound.receive_us);
    if (lower_bound(bound, origin_).lo > at(receive_s).hi + rounding_s) return PingFate::too_late;
  }
  const bool early = origin_.offset_s(bound.send_us, bound.not_after) < at(send_s).lo - rounding_s;
  return early ? PingFate::too_early : PingFate::fits;
}

double PingBounds::missed_by_s(const PingBound& bound) const {
  const double early_s = at(bound.send_us).lo - origin_.offset_s(bound.send_us, bound.not_after);
  if (!bound.two_sided) return early_s;
  return std::max(early_s, origin_.offset_s(bound.receive_us, bound.not_before) - at(bound.receive_us).hi);
}

void PingBounds::take(const PingBound& bound) {
  if (bound.two_sided) constrain(origin_.mcu_s(bound.receive_us), lower_bound(bound, origin_));
  two_sided_ = two_sided_ || bound.two_sided;
  constrain(origin_.mcu_s(bound.send_us), upper_bound(bound, origin_));
  newest_us_ = std::max(newest_us_, bound.send_us);
  if (newest_.mcu_s - knots_.back().mcu_s >= knot_period_s) set_knot();
}

void PingBounds::constrain(double mcu_s, const Range& offset) {
  Knot given{mcu_s, offset};
  if (mcu_s >= newest_.mcu_s)
    newest_ = {mcu_s, onward(newest_, mcu_s)};
  else
    given = {newest_.mcu_s, onward(given, newest_.mcu_s)};
  newest_.offset = {std::max(newest_.offset.lo, given.offset.lo),
                    std::min(newest_.offset.hi, given.offset.hi)};
  if (newest_.offset.empty()) std::swap(newest_.offset.lo, newest_.offset.hi);  // within rounding
}

void PingBounds::set_knot() {
  knots_.push_back(newest_);
  while (newest_.mcu_s - knots_.front().mcu_s > rate_window_s && knots_.size() > 2) knots_.pop_front();
  refine_knots();
  bound_rate();
}

void PingBounds::refine_knots() {
  for (std::size_t i = knots_.size() - 1; i > 0; --i) {
    const Range range = backward(knots_[i], knots_[i - 1].mcu_s);
    Range& before = knots_[i - 1].offset;
    before = {std::max(before.lo, range.lo), std::min(before.hi, range.hi)};
  }
}

void PingBounds::bound_rate() {
  rate_ = {-max_rate, max_rate};
  const double history_s = newest_.mcu_s - knots_.front().mcu_s;
  for (const Knot& knot : knots_) {
    const double span_s = newest_.mcu_s - knot.mcu_s;
    if (span_s < history_s / 2 || !(span_s > 0.0)) break;
    rate_.lo = std::max(rate_.lo, (newest_.offset.lo - knot.offset.hi) / span_s);
    rate_.hi = std::min(rate_.hi, (newest_.offset.hi - knot.offset.lo) / span_s);
  }
  // Means over different stretches may differ, but not by more than the wander allows.
  if (rate_.lo - rate_.hi > 2 * wander_) std::swap(rate_.lo, rate_.hi);
  if (rate_now_ == RateNow::may_differ) rate_ = rate_aside(rate_, history_s / 2, drift(), width_s());
}

double PingBounds::width_s() const {
  std::vector<Range> offsets;
  for (const Knot& knot : knots_) offsets.push_back(knot.offset);
  return median_width_s(offsets);
}

/// By how much the mean rate changes from the first half of the window to the second, per second.
double PingBounds::drift() const {
  const Knot& middle = knots_[knots_.size() / 2];
  const auto mean_rate = [](const Knot& from, const Knot& to) {
    return (to.offset.middle() - from.offset.middle()) / (to.mcu_s - from.mcu_s);
  };
  const double change = mean_rate(middle, newest_) - mean_rate(knots_.front(), middle);
  const double drift = change / ((newest_.mcu_s - knots_.front().mcu_s) / 2);
  return std::isfinite(drift) ? drift : 0.0;
}

}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#include "ping_hull.h"

#include <algorithm>
#include <cmath>

namespace thermorig::fit {
namespace {

constexpr double hull_knot_period_s = 2.0;

// Each pass narrows the rate, which narrows the bounds, which narrow the rate: from 2 % to a few ppm above
// the wander in four.
constexpr int hull_passes = 5;

Range intersection(const Range& a, const Range& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}

Range range_in_order(const Range& range) {
  return range.empty() ? Range{range.hi, range.lo} : range;
}

}  // namespace

PingHull::PingHull(std::span<const Event> events, double wander, double unseen_s)
    : wander_(wander),
      unseen_s_(unseen_s),
      events_(events),
      offsets_(events_.size()),
      begins_(events_.size(), 0) {
  if (events_.empty()) return;
  begins_.front() = 1;
  place_knots();
  rates_.assign(knots_.size(), {-max_rate, max_rate});
  windows_.resize(knots_.size());
  for (int pass = 0; pass < hull_passes; ++pass) {
    forward();
    backward();
    bound_rates();
  }
  std::sort(breaks_.begin(), breaks_.end(), [](const Break& a, const Break& b) { return a.event < b.event; });
}

void PingHull::place_knots() {
  for (std::size_t i = 0; i < events_.size(); ++i) {
    const bool last = i + 1 == events_.size();
    if (knots_.empty() || last || events_[i].mcu_s - events_[knots_.back()].mcu_s >= hull_knot_period_s)
      knots_.push_back(i);
  }
}

void PingHull::split(std::size_t event, double missed_s) {
  begins_[event] = 1;
  breaks_.push_back({event, missed_s});
}

void PingHull::forward() {
  std::size_t segment = 0;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    Range reached;
    if (!begins(i)) {
      while (segment + 1 < knots_.size() && knots_[segment + 1] <= i - 1) ++segment;
      const double span_s = events_[i].mcu_s - events_[i - 1].mcu_s;
      reached = {offsets_[i - 1].lo + rates_[segment].lo * span_s,
                 offsets_[i - 1].hi + rates_[segment].hi * span_s};
    }
    const Range both = intersection(reached, events_[i].given);
    if (both.lo - both.hi > rounding_s && !begins(i)) {
      split(i, both.lo - both.hi);
      offsets_[i] = range_in_order(events_[i].given);
    } else {
      offsets_[i] = range_in_order(both);
    }
  }
}

void PingHull::backward() {
  std::size_t segment = knots_.size() - 1;
  for (std::size_t i = events_.size() - 1; i-- > 0;) {
    if (begins(i + 1)) continue;
    while (knots_[segment] > i) --segment;
    const double span_s = events_[i + 1].mcu_s - events_[i].mcu_s;
    const Range reached{offsets_[i + 1].lo - rates_[segment].hi * span_s,
                        offsets_[i + 1].hi - rates_[segment].lo * span_s};
    offsets_[i] = range_in_order(intersection(offsets_[i], reached));
  }
}

Range PingHull::mean_rate(std::size_t first, std::size_t last) const {
  const double span_s = events_[last].mcu_s - events_[first].mcu_s;
  if (!(span_s > 0.0)) return {};
  return {(offsets_[last].lo - offsets_[first].hi) / span_s,
          (offsets_[last].hi - offsets_[first].lo) / span_s};
}

/// Micro-controller times of the window around a segment: at an end of the recording it lies to one side.
Range PingHull::window(std::size_t segment) const {
  const double begin_s = events_.front().mcu_s;
  const double end_s = events_.back().mcu_s;
  const double middle_s = (events_[knots_[segment]].mcu_s + events_[knots_[segment + 1]].mcu_s) / 2;
  const double from_s = std::max(begin_s, std::min(middle_s - rate_window_s / 2, end_s - rate_window_s));
  return {from_s, from_s + rate_window_s};
}

/// The window of each segment, none where the clock starts anew within it.
void PingHull::place_windows() {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t stretch = 0;  // knots before it belong to another clock
  for (std::size_t k = 0; k + 1 < knots_.size(); ++k) {
    windows_[k].reset();
    const Range around = window(k);
    for (std::size_t i = knots_[k] + 1; i <= knots_[k + 1]; ++i)
      if (begins(i)) stretch = k + 1;
    if (stretch > k) continue;  // a break within the segment
    while (first < k && (first < stretch || events_[knots_[first]].mcu_s < around.lo)) ++first;
    last = std::max(last, k + 1);
    const auto joins = [&](std::size_t knot) {
      return knot < knots_.size() && events_[knots_[knot]].mcu_s <= around.hi &&
             std::none_of(begins_.begin() + static_cast<std::ptrdiff_t>(knots_[knot - 1]) + 1,
                          begins_.begin() + static_cast<std::ptrdiff_t>(knots_[knot]) + 1,
                          [](char begin) { return begin != 0; });
    };
    while (joins(last + 1)) ++last;
    windows_[k] = Window{middle_s(knots_[first], knots_[last]),
                         events_[knots_[last]].mcu_s - events_[knots_[first]].mcu_s,
                         mean_rate(knots_[first], knots_[last])};
  }
}

double PingHull::middle_s(std::size_t first, std::size_t last) const {
  return (events_[first].mcu_s + events_[last].mcu_s) / 2;
}

/// By how much mean rates change from the window of a segment to that half a window on, per second. `step`: 1
/// or -1, from segment to segment, towards where windows do not lie to one side.
double PingHull::drift(std::size_t segment, std::ptrdiff_t step) const {
  const Window& own = *windows_[segment];
  const auto end = std::ssize(windows_) - 1;
  for (auto k = static_cast<std::ptrdiff_t>(segment); k >= 0 && k < end; k += step) {
    const auto& other = windows_[static_cast<std::size_t>(k)];
    if (!other) break;
    const double away_s = other->middle_s - own.middle_s;
    if (std::abs(away_s) >= rate_window_s / 2) return (other->mean.middle() - own.mean.middle()) / away_s;
  }
  return 0.0;
}

/// What the rate of a segment may be by its window, which lies to one side at an end of the clock's life.
Range PingHull::allowed(std::size_t segment) const {
  const Window& own = *windows_[segment];
  const double reach = wander_reach_s(own.span_s, wander_) / std::max(own.span_s, 1e-9);
  const Range rates{own.mean.lo - reach, own.mean.hi + reach};
  if (!(unseen_s_ > 0.0)) return rates;
  const double aside_s = middle_s(knots_[segment], knots_[segment + 1]) - own.middle_s;
  return rate_aside(rates, aside_s, drift(segment, aside_s < 0.0 ? 1 : -1), unseen_s_);
}

void PingHull::bound_rates() {
  place_windows();
  for (std::size_t k = 0; k + 1 < knots_.size(); ++k) {
    if (!windows_[k]) continue;
    rates_[k] = intersection(rates_[k], allowed(k));
    if (!rates_[k].empty()) continue;
    rates_agree_ = false;
    rates_[k] = range_in_order(rates_[k]);
  }
}

double PingHull::rate_at(std::size_t knot) const {
  const std::size_t segment = std::min(knot, knots_.size() < 2 ? 0 : knots_.size() - 2);
  return (rates_[segment].lo + rates_[segment].hi) / 2;
}

}  // namespace thermorig::fit

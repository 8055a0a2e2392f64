// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "clock_summary.h"
#include "ping_hull.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/statistics.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/timing/ping_bounds.h"
#include "thermorig/pipeline/timing/ping_clock.h"

namespace thermorig::fit {

using namespace timing;

namespace {

/// How a servo's clock did, gathered epoch by epoch.
class PingReport {
 public:
  explicit PingReport(const PortProfile& link);

  void add(const ClockEpoch& epoch, const PingHull& hull, const ClockOrigin& origin);

  /// Of an epoch: what was needed to explain it, infinite where nothing does, and what its bounds allow for;
  /// 0: not checked.
  void add_wander(double needed, double checked);

  /// `mcu_us` and their `times`: rate, widths, gaps.
  ClockReport finish(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times, bool two_way);

 private:
  void add_knots(const PingHull& hull, const ClockOrigin& origin);
  void add_lateness(const PingHull& hull);
  void find_gaps(std::span<const std::int64_t> mcu_us, std::span<const TimeEstimate> times);
  void measure_widths(std::span<const TimeEstimate> times);

  PortProfile link_;
  ClockReport report_;
  double largest_needed_ = 0.0;  // wander
  double largest_checked_ = 0.0;
  bool is_checked_ = true;
  std::vector<float> late_s_;
};

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

/// Everything that belongs to one epoch.
struct EpochData {
  ClockEpoch epoch;
  std::vector<PingBound> bounds;
  std::vector<std::size_t> asked;  // indices into mcu_us
};

/// Both kinds of messages in the order in which they arrived. The micro-controller's time decides between
/// those that arrived together.
std::vector<PingBound> in_order(std::span<const PingBound> exchanges, std::span<const PingBound> sent,
                                std::vector<std::size_t>& place_of_sent) {
  std::vector<PingBound> bounds;
  bounds.reserve(exchanges.size() + sent.size());
  std::size_t next = 0;
  for (const PingBound& stamp : sent) {
    for (; next < exchanges.size() && exchanges[next].not_after <= stamp.not_after; ++next)
      if (exchanges[next].send_us >= exchanges[next].receive_us) bounds.push_back(exchanges[next]);
    place_of_sent.push_back(bounds.size());
    bounds.push_back(stamp);
  }
  for (; next < exchanges.size(); ++next)
    if (exchanges[next].send_us >= exchanges[next].receive_us) bounds.push_back(exchanges[next]);
  return bounds;
}

/// Bounds by epoch, those that fit no clock left out; `epoch_of` says of each bound to which it belongs.
std::vector<EpochData> split(const std::vector<PingBound>& bounds, const PortProfile& link,
                             std::vector<std::size_t>& epoch_of) {
  PingClock follower(link);
  std::vector<char> doubted;
  for (const PingBound& bound : bounds) {
    follower.feed(bound);
    doubted.push_back(follower.doubted());
  }
  std::vector<EpochData> epochs;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    while (epochs.size() < follower.epochs().size() && follower.first_bounds()[epochs.size()] <= i)
      epochs.push_back({.epoch = follower.epochs()[epochs.size()]});
    epoch_of.push_back(epochs.size() - 1);
    if (!doubted[i]) epochs.back().bounds.push_back(bounds[i]);
  }
  return epochs;
}

/// Gives each time that is asked for to the epoch in which it was sent: both go through the same steps back.
class EpochFinder {
 public:
  EpochFinder(std::span<const PingBound> sent, const std::vector<std::size_t>& epoch_of_sent)
      : sent_(sent), epoch_of_sent_(epoch_of_sent) {}

  std::size_t find(std::int64_t mcu_us) {
    if (asked_before_ && stepped_back(*asked_before_, mcu_us)) skip_life();
    asked_before_ = mcu_us;
    while (at_ + 1 < sent_.size() && !stepped_back(sent_[at_].send_us, sent_[at_ + 1].send_us) &&
           sent_[at_ + 1].send_us <= mcu_us)
      ++at_;
    return epoch_of_sent_.empty() ? 0 : epoch_of_sent_[at_];
  }

 private:
  static bool stepped_back(std::int64_t before_us, std::int64_t now_us) {
    return seconds_between(before_us, now_us) < -order_tolerance_s;
  }
  void skip_life() {
    for (std::size_t i = at_ + 1; i < sent_.size(); ++i)
      if (stepped_back(sent_[i - 1].send_us, sent_[i].send_us)) {
        at_ = i;
        return;
      }
  }

  std::span<const PingBound> sent_;
  const std::vector<std::size_t>& epoch_of_sent_;
  std::size_t at_ = 0;
  std::optional<std::int64_t> asked_before_;
};

/// An estimate that says nothing.
TimeEstimate unknown_time() {
  const float nothing = std::numeric_limits<float>::infinity();
  return {.uncertainty_s = nothing, .earlier_s = nothing, .later_s = nothing};
}

struct Asked {
  PingHull::Event event;
  std::size_t index;  // of mcu_us, or `none`
};
constexpr double longest_late_s = 2.0;  // a message waits in a port's buffer: then that is full
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

std::vector<Asked> events_of(const EpochData& data, std::span<const std::int64_t> mcu_us,
                             const ClockOrigin& origin) {
  std::vector<Asked> events;
  events.reserve(2 * data.bounds.size() + data.asked.size());
  for (const PingBound& bound : data.bounds) {
    if (bound.two_sided)
      events.push_back({{origin.mcu_s(bound.receive_us), lower_bound(bound, origin)}, none});
    events.push_back({{origin.mcu_s(bound.send_us), upper_bound(bound, origin)}, none});
  }
  for (const std::size_t index : data.asked) events.push_back({{origin.mcu_s(mcu_us[index]), {}}, index});
  std::stable_sort(events.begin(), events.end(),
                   [](const Asked& a, const Asked& b) { return a.event.mcu_s < b.event.mcu_s; });
  return events;
}

/// Times of one epoch that may belong to the next: nothing but telemetry came between the last answer that
/// the clock before explains and the first message that it does not, and the clock jumped somewhere there.
struct Doubtful {
  std::size_t index = 0;  // of mcu_us
  HostTime not_after{};   // its message had come by then
};

std::vector<Doubtful> doubtful_at_end(const EpochData& data, const EpochData& next,
                                      std::span<const std::int64_t> mcu_us) {
  if (data.bounds.empty() || next.bounds.empty()) return {};
  if (next.bounds.front().send_us < data.bounds.back().send_us) return {};  // a reset: its time ran back
  std::unordered_map<std::int64_t, HostTime> not_after;
  std::int64_t sure_us = data.bounds.front().send_us;
  for (auto bound = data.bounds.rbegin(); bound != data.bounds.rend(); ++bound) {
    if (bound->two_sided) {
      sure_us = bound->send_us;
      break;
    }
    not_after[bound->send_us] = bound->not_after;
  }
  std::vector<Doubtful> doubtful;
  for (auto index = data.asked.rbegin(); index != data.asked.rend() && mcu_us[*index] > sure_us; ++index)
    if (const auto stamp = not_after.find(mcu_us[*index]); stamp != not_after.end())
      doubtful.push_back({*index, stamp->second});
  return doubtful;
}

/// Widens the bounds of a time to those that the next epoch's clock gives it, where that clock may be the
/// true one: the message was not read before it was sent, nor later than any message is.
void allow_for(const TimeEstimate& next, HostTime not_after, TimeEstimate& time) {
  const double read_late_s = seconds_between(next.time, not_after);
  if (!std::isfinite(next.later_s) || read_late_s < -static_cast<double>(next.earlier_s) ||
      read_late_s > longest_late_s)
    return;
  const auto ahead_s = static_cast<float>(seconds_between(time.time, next.time));
  time.later_s = std::max(time.later_s, ahead_s + next.later_s);
  time.earlier_s = std::max(time.earlier_s, next.earlier_s - ahead_s);
  time.uncertainty_s = std::max(time.uncertainty_s, (time.later_s + time.earlier_s) / std::sqrt(12.0F));
}

/// Where nothing bounds the clock from below, the fastest message is taken to be late by the largest constant
/// delay at most.
Range closed(Range offset, double largest_constant_delay_s) {
  if (offset.lo == -unbounded) offset.lo = offset.hi - largest_constant_delay_s;
  return offset;
}

struct Followed {
  PingHull likely;             // of a wander that explains all events
  PingHull sure;               // of one that they would tell from a larger one: bounds are its
  double needed_wander = 0.0;  // infinite: not even the largest explains all events; 0: not checked
  double sure_wander = 0.0;    // 0: either
};

double width_s(const PingHull& hull) {
  return median_width_s(hull.offsets());
}

/// Whether bounds are so narrow that a clock which wanders more would not fit between them: one that loses
/// for half a window and gains for the other, or, where it is known to be worse than its profile says, one
/// that waves from window to window.
bool tells(const PingHull& hull, double wander, bool is_worse) {
  return width_s(hull) <= rate_window_s * wander / (is_worse ? std::numbers::pi : 2.0);
}

/// The same hull for a clock that may bow unseen as far as the bounds are wide.
PingHull bowed(const PingHull& hull, double wander) {
  return PingHull(hull.events(), wander, width_s(hull));
}

/// Whether half the wander explains all events barely, with bounds that are pressed together. Of answers that
/// are late by chance that one binds whose lateness plus wander times age is least, and this least grows as
/// the root of the wander. Bounds that grow faster were held by a contradiction.
bool is_pressed(const PingHull& half, const PingHull& whole) {
  return width_s(whole) > std::numbers::sqrt2 * width_s(half);
}

/// The likely wander is twice the least one of those tried that explains all events, and does not press their
/// bounds together: between two pings that tell, a clock may have gone further than they show. The wider the
/// bounds, the further.
Followed follow(const std::vector<PingHull::Event>& events, double wander) {
  const double stated = wander;
  if (wander > largest_wander) {
    const PingHull hull(events, largest_wander);
    return {hull, hull, 0.0, 0.0};
  }
  PingHull half(events, 0.5 * wander);
  while (wander <= largest_wander && !half.explains_all()) {
    wander *= 2.0;
    half = PingHull(events, 0.5 * wander);
  }
  PingHull likely(events, std::min(wander, largest_wander));
  if (wander > largest_wander) return {likely, likely, std::numeric_limits<double>::infinity(), 0.0};
  while (2.0 * wander <= largest_wander && is_pressed(half, likely)) {
    wander *= 2.0;
    half = std::exchange(likely, PingHull(events, wander));
  }
  const double needed = wander;
  PingHull sure = likely;
  while (2.0 * wander <= largest_wander && !tells(sure, wander, needed > stated))
    sure = PingHull(events, wander *= 2.0);
  return {std::move(likely), bowed(sure, wander), needed, wander};
}

void fit_epoch(const EpochData& data, std::span<const std::int64_t> mcu_us, const PortProfile& link,
               PingFit& fit, PingReport& report) {
  if (data.bounds.empty()) return;
  const ClockOrigin origin{data.bounds.front().not_after, data.bounds.front().send_us};
  const std::vector<Asked> asked = events_of(data, mcu_us, origin);
  std::vector<PingHull::Event> events;
  events.reserve(asked.size());
  for (const Asked& one : asked) events.push_back(one.event);
  const bool is_bounded =
      std::any_of(data.bounds.begin(), data.bounds.end(), [](const PingBound& b) { return b.two_sided; });
  const auto [likely, sure, needed_wander, sure_wander] =
      follow(events, std::max(wander_of(link), least_wander));
  const double delay_s = link.largest_constant_delay_s;
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (asked[i].index != none)
      fit.times[asked[i].index] =
          within(origin.estimate(asked[i].event.mcu_s, closed(likely.offsets()[i], delay_s)),
                 origin.estimate(asked[i].event.mcu_s, closed(sure.offsets()[i], delay_s)));
  report.add(data.epoch, sure, origin);
  if (is_bounded)
    report.add_wander(needed_wander, sure_wander);
  else
    report.add_wander(0.0, 0.0);
}

/// Fits an epoch. What may belong to it or to the one before it keeps the times of that one, within bounds
/// that hold for the clocks of both.
void fit_after(const EpochData& before, const EpochData& data, std::span<const std::int64_t> mcu_us,
               const PortProfile& link, PingFit& fit, PingReport& report) {
  const std::vector<Doubtful> doubtful = doubtful_at_end(before, data, mcu_us);
  if (doubtful.empty()) return fit_epoch(data, mcu_us, link, fit, report);
  EpochData both = data;
  std::vector<TimeEstimate> times;
  for (const Doubtful& one : doubtful) {
    times.push_back(fit.times[one.index]);
    both.asked.push_back(one.index);
  }
  fit_epoch(both, mcu_us, link, fit, report);
  for (std::size_t i = 0; i < doubtful.size(); ++i) {
    allow_for(fit.times[doubtful[i].index], doubtful[i].not_after, times[i]);
    fit.times[doubtful[i].index] = times[i];
  }
}

}  // namespace

PingFit fit_pings(std::span<const std::int64_t> mcu_us, std::span<const PingBound> exchanges,
                  std::span<const PingBound> sent, const PortProfile& link) {
  std::vector<std::size_t> place_of_sent;
  std::vector<std::size_t> epoch_of;
  const std::vector<PingBound> bounds = in_order(exchanges, sent, place_of_sent);
  std::vector<EpochData> epochs = split(bounds, link, epoch_of);
  PingFit fit;
  fit.times.resize(mcu_us.size(), unknown_time());
  PingReport report(link);
  if (epochs.empty()) return fit;
  std::vector<std::size_t> epoch_of_sent;
  for (const std::size_t place : place_of_sent) epoch_of_sent.push_back(epoch_of[place]);
  EpochFinder finder(sent, epoch_of_sent);
  for (std::size_t i = 0; i < mcu_us.size(); ++i) epochs[finder.find(mcu_us[i])].asked.push_back(i);
  for (std::size_t i = 0; i < epochs.size(); ++i)
    fit_after(i > 0 ? epochs[i - 1] : EpochData(), epochs[i], mcu_us, link, fit, report);
  fit.report = report.finish(mcu_us, fit.times, !exchanges.empty());
  return fit;
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "clock_summary.h"
#include "sliding_fit.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/timing/least_lateness.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/pipeline/timing/lower_line.h"

namespace thermorig::fit {

using namespace timing;

namespace {

/// One segment of a device's clock. Host times count in seconds from `origin`.
struct SegmentFit {
  std::vector<double> time_s;     // of each message: its first byte began
  std::vector<double> earlier_s;  // bounds about it
  std::vector<double> later_s;
  std::vector<double> uncertainty_s;
  std::vector<double> late_s;  // of each inequality
  std::vector<ClockKnot> knots;
  double slope = 1.0;  // host seconds a device second, mean
};

/// What is known of the device before its clock is fitted.
struct DeviceClock {
  SlidingWindow window;
  double step_s = 0.0;  // between messages, on its own clock
  double wander = 0.0;  // relative
  double largest_constant_delay_s = 0.0;
};

// So close to the curve an inequality holds it up.
constexpr double holding_up_s = 50e-6;
constexpr double nowhere_s = 1e6;  // bounds of a segment without any inequality

// Beyond these no clock is; they keep nonsense finite.
constexpr double slowest = 0.01;  // host seconds a device second
constexpr double fastest = 100.0;
constexpr double farthest_s = 2e9;

/// As floating point, which no two instants overflow.
double since(HostTime origin, HostTime time) {
  const double ns = static_cast<double>(to_ns(time)) - static_cast<double>(to_ns(origin));
  return std::clamp(ns * 1e-9, -farthest_s, farthest_s);
}

/// Bytes that nobody sent may leave a curve without a value; `otherwise` is finite.
double sound(double seconds, double otherwise) {
  return std::clamp(std::isfinite(seconds) ? seconds : otherwise, -farthest_s, farthest_s);
}

HostTime host_time(HostTime origin, double seconds) {
  return origin + from_s(seconds);
}

/// A segment in coordinates in which its clock is nearly level: x device seconds since its begin, y host
/// seconds minus `slope` x.
class SegmentFitting {
 public:
  SegmentFitting(std::span<const double> device_s, std::span<const LatestBegin> latest,
                 const DeviceClock& device, HostTime origin)
      : device_s_(device_s), latest_(latest), device_(device), origin_(origin), x0_(device_s.front()) {
    for (const LatestBegin& begin : latest)
      ceilings_.push_back({begin.device_s - x0_, since(origin, begin.latest)});
    fit_.slope = std::clamp(lower_line_slope(ceilings_, 1.0), slowest, fastest);
    for (Ceiling& ceiling : ceilings_) ceiling.y -= fit_.slope * ceiling.x;
    const double length_s = device_s.back() - device_s.front();
    for (const LatestBegin& begin : latest) baud_s_ = std::max(baud_s_, baud_tolerance * begin.wire_s);
    drift_ = device.wander * std::abs(fit_.slope) + rate_slack_s / std::max(length_s, rate_slack_s);
  }

  SegmentFit run() {
    if (ceilings_.empty()) return nowhere();
    SlidingFit curve(ceilings_, device_.window, drift_);
    for (const Ceiling& ceiling : ceilings_) fit_.late_s.push_back(ceiling.y - curve.at(ceiling.x));
    std::vector<double> level_s(device_s_.size());
    for (std::size_t i = 0; i < level_s.size(); ++i) level_s[i] = curve.at(x(i));
    bound_above();
    const LeastLateness least = estimate_least(curve);
    bound_below(level_s, least.longest_hold_s);
    add_messages(level_s, least.at_knots_s, curve);
    add_knots(curve);
    return std::move(fit_);
  }

 private:
  double x(std::size_t i) const { return device_s_[i] - x0_; }

  /// Both passes that carry `bound` along the messages: between neighbours the clock drifts by no more than
  /// `drift_`. `side` is 1 for a bound from above, -1 for one from below.
  void carry(std::vector<double>& bound_s, double side) const {
    const auto tighten = [&](std::size_t to, std::size_t from) {
      const double carried_s = bound_s[from] + side * drift_ * std::abs(x(to) - x(from));
      if (side * carried_s < side * bound_s[to]) bound_s[to] = carried_s;
    };
    for (std::size_t i = 1; i < bound_s.size(); ++i) tighten(i, i - 1);
    for (std::size_t i = bound_s.size() - 1; i-- > 0;) tighten(i, i + 1);
  }

  /// Applies `use` to each inequality and its message.
  template <typename Use>
  void for_each_ceiling(Use use) const {
    std::size_t message = 0;
    for (const Ceiling& ceiling : ceilings_) {
      while (message + 1 < device_s_.size() && x(message) < ceiling.x) ++message;
      use(message, ceiling);
    }
  }

  void bound_above() {
    above_s_.assign(device_s_.size(), std::numeric_limits<double>::infinity());
    for_each_ceiling([&](std::size_t i, const Ceiling& ceiling) {
      const double here_s = ceiling.y + drift_ * std::abs(ceiling.x - x(i));
      above_s_[i] = std::min(above_s_[i], here_s);
    });
    carry(above_s_, 1.0);
  }

  /// An inequality that holds the curve up is late by no more than the largest constant delay.
  void bound_below(std::span<const double> level_s, double hold_s) {
    const double delay_s = device_.largest_constant_delay_s + hold_s;
    const double far_s = delay_s + drift_ * 0.5 * device_.window.length_s;
    below_s_.resize(device_s_.size());
    for (std::size_t i = 0; i < below_s_.size(); ++i) below_s_[i] = level_s[i] - far_s;
    std::size_t index = 0;
    for_each_ceiling([&](std::size_t i, const Ceiling& ceiling) {
      if (fit_.late_s[index++] > holding_up_s) return;
      below_s_[i] = std::max(below_s_[i], ceiling.y - delay_s - drift_ * std::abs(ceiling.x - x(i)));
    });
    carry(below_s_, -1.0);
    // Where the clock ran further than it may, the bounds would cross: that much is unknown in any case.
    for (std::size_t i = 0; i < below_s_.size(); ++i)
      below_s_[i] = std::min(below_s_[i], above_s_[i] - delay_s);
  }

  LeastLateness estimate_least(const SlidingFit& curve) const {
    std::vector<timing::MessageReads> messages;
    for (std::size_t begin = 0, end = 0; begin < latest_.size(); begin = end) {
      while (end < latest_.size() && latest_[end].device_s == latest_[begin].device_s) ++end;
      messages.push_back(timing::message_reads(latest_.subspan(begin, end - begin)));
    }
    std::vector<CurveRise> rises;
    for (const SlidingFit::Knot& knot : curve.knots()) rises.push_back({knot.x, knot.rise});
    return timing::least_lateness({latest_, messages, x0_, [&](std::size_t i) { return fit_.late_s[i]; }},
                                  device_.step_s, rises, device_.window.length_s);
  }

  void add_messages(std::span<const double> level_s, std::span<const Estimate> least_s, SlidingFit& curve) {
    std::vector<double> expected_s;
    std::vector<double> uncertain_s;
    for (const Estimate& least : least_s) {
      expected_s.push_back(least.value);
      uncertain_s.push_back(least.uncertainty);
    }
    for (std::size_t i = 0; i < level_s.size(); ++i) {
      const double above_s = sound(above_s_[i], 0.0);
      const double time_s = std::min(sound(level_s[i] - curve.blend(expected_s, x(i)), above_s), above_s);
      fit_.time_s.push_back(sound(fit_.slope * x(i) + time_s, 0.0));
      fit_.later_s.push_back(above_s_[i] - time_s + baud_s_);
      fit_.earlier_s.push_back(std::max(0.0, time_s - below_s_[i]) + baud_s_);
      fit_.uncertainty_s.push_back(curve.blend(uncertain_s, x(i)));
    }
  }

  void add_knots(SlidingFit& curve) {
    std::size_t next = 0;
    std::vector<double> late_s;
    for (const SlidingFit::Knot& knot : curve.knots()) {
      late_s.clear();
      for (; next < ceilings_.size() && ceilings_[next].x <= knot.x + 0.5 * device_.window.block_s; ++next)
        late_s.push_back(fit_.late_s[next]);
      const double host_s = sound(fit_.slope * knot.x + curve.at(knot.x), fit_.slope * knot.x);
      ClockKnot out{.time = host_time(origin_, host_s)};
      out.offset_s = to_s(out.time.time_since_epoch()) - (knot.x + x0_);
      out.skew_ppm = (fit_.slope - 1.0 + curve.slope(knot.x)) * 1e6;
      out.residual_us = lower_quantile(late_s, 0.5) * 1e6;
      fit_.knots.push_back(out);
    }
  }

  /// Without any inequality nothing is known but that nothing is known.
  SegmentFit nowhere() {
    for (std::size_t i = 0; i < device_s_.size(); ++i) fit_.time_s.push_back(x(i));
    fit_.earlier_s.assign(device_s_.size(), nowhere_s);
    fit_.later_s = fit_.uncertainty_s = fit_.earlier_s;
    return std::move(fit_);
  }

  std::span<const double> device_s_;
  std::span<const LatestBegin> latest_;  // all of them have a finite device_s
  const DeviceClock& device_;
  HostTime origin_;
  double x0_;
  double baud_s_ = 0.0;  // by so much may the wire times that were taken off be wrong, either way
  double drift_ = 0.0;   // per second of the device's clock, against the mean rate
  std::vector<Ceiling> ceilings_;
  std::vector<double> above_s_;
  std::vector<double> below_s_;
  SegmentFit fit_;
};

SegmentFit fit_segment(std::span<const double> device_s, std::span<const LatestBegin> latest,
                       const DeviceClock& device, HostTime origin) {
  return SegmentFitting(device_s, latest, device, origin).run();
}

/// Messages, and inequalities on them, that one curve explains.
struct Segment {
  std::size_t begin = 0;  // messages
  std::size_t end = 0;
  std::size_t latest_begin = 0;  // inequalities
  std::size_t latest_end = 0;
  bool new_epoch = false;  // the device's clock was reset before it
};

constexpr double no_clock_s = 1e9;

bool is_clock(double device_s) {
  return std::isfinite(device_s) && std::abs(device_s) < no_clock_s;
}

/// Inequalities come in the order of the messages: those of a segment are the next ones, as long as they do
/// not step back and lie within it.
std::size_t end_of_latest(std::span<const LatestBegin> latest, std::size_t begin, double last_s) {
  std::size_t end = begin;
  double before_s = -no_clock_s;
  for (; end < latest.size(); ++end) {
    const double device_s = latest[end].device_s;
    if (!is_clock(device_s) || device_s < before_s || device_s > last_s) break;
    before_s = device_s;
  }
  return end;
}

/// `device_s` without values that no clock shows (not finite, beyond a billion seconds): each of them is
/// replaced by the one before.
std::vector<double> clean_device_s(std::span<const double> device_s) {
  std::vector<double> clean(device_s.begin(), device_s.end());
  double before_s = 0.0;
  for (const double value : device_s)
    if (is_clock(value)) {
      before_s = value;
      break;
    }
  for (double& value : clean) before_s = value = is_clock(value) ? value : before_s;
  return clean;
}

/// Splits where the device's clock steps back, and where it says nothing for longer than `longest_gap_s`:
/// over such a gap nothing carries, since the clock may have wandered and the count of what is missing is a
/// guess.
std::vector<Segment> find_segments(std::span<const double> device_s, std::span<const LatestBegin> latest,
                                   double longest_gap_s) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < device_s.size(); ++i) {
    const double step_s = i == 0 ? 0.0 : device_s[i] - device_s[i - 1];
    if (i == 0 || step_s < 0.0 || step_s > longest_gap_s)
      segments.push_back({.begin = i, .end = i, .new_epoch = step_s < 0.0});
    segments.back().end = i + 1;
  }
  std::size_t next = 0;
  for (Segment& segment : segments) {
    segment.latest_begin = next;
    next = segment.latest_end = end_of_latest(latest, next, device_s[segment.end - 1]);
  }
  return segments;
}

constexpr double missing_periods =
    1.5;  // so long a step of the device's clock is one in which something lacks
constexpr double most_missing = 1e12;
constexpr double countable_share =
    0.125;  // of a period: drift over a gap whose messages can still be counted

constexpr double stray_span_s = 10.0;          // a busy host reads something in time within it,
constexpr std::size_t fewest_in_span = 50;     // of so many chunks
constexpr double largest_wander_ppm = 4000.0;  // that is tried

constexpr double jitter_quantile =
    0.95;                       // of the usual steps: they stray less from the median than that one does
constexpr double strays = 2.0;  // so many times may one that lacks nothing

double median_step_s(std::span<const double> device_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < device_s.size(); ++i)
    if (device_s[i] > device_s[i - 1]) steps.push_back(device_s[i] - device_s[i - 1]);
  return lower_quantile(steps, 0.5);
}

/// A longer step of the device's clock lacks something. A device that keeps no exact rhythm has longer ones
/// now and then, by its own time; where messages were counted all steps are whole periods.
double longest_whole_step_s(std::span<const double> device_s, double median_s) {
  std::vector<double> strays_s;
  for (std::size_t i = 1; i < device_s.size(); ++i) {
    const double step_s = device_s[i] - device_s[i - 1];
    if (step_s > 0.0 && step_s <= missing_periods * median_s) strays_s.push_back(std::abs(step_s - median_s));
  }
  return missing_periods * median_s + strays * lower_quantile(strays_s, jitter_quantile);
}

/// Whether there is a span in which even the fastest chunk came later, by the curve, than any fastest one
/// does.
bool has_stray_span(std::span<const LatestBegin> latest, std::span<const double> late_s,
                    double largest_constant_delay_s) {
  for (std::size_t begin = 0; begin < latest.size();) {
    std::size_t end = begin;
    double least_s = late_s[begin];
    for (; end < latest.size() && latest[end].device_s < latest[begin].device_s + stray_span_s; ++end)
      least_s = std::min(least_s, late_s[end]);
    if (end == begin) return false;  // a time that is none
    if (end - begin >= fewest_in_span && least_s > largest_constant_delay_s) return true;
    begin = end;
  }
  return false;
}

class ArrivalFit {
 public:
  ArrivalFit(std::span<const double> device_s, std::span<const LatestBegin> latest, const PortProfile& link,
             double nominal_rate_hz)
      : device_s_(clean_device_s(device_s)), latest_(latest), link_(link), step_s_(median_step_s(device_s_)) {
    const double rate_hz = step_s_ > 0.0 ? 1.0 / step_s_ : nominal_rate_hz;
    clock_.window = SlidingWindow::of(link.wander_ppm, rate_hz);
    clock_.step_s = step_s_;
    clock_.wander = std::max(link.wander_ppm, 0.0) * 1e-6;
    clock_.largest_constant_delay_s = link.largest_constant_delay_s;
    if (!latest.empty()) origin_ = latest.front().latest;
  }

  /// Whether nothing came near the curve for a while: the clock, or the host's, wanders more than was allowed
  /// for. Of run().
  bool strays() const { return strays_; }

  ArrivalClock run() {
    result_.times.reserve(device_s_.size());
    for (const Segment& segment : find_segments(device_s_, latest_, longest_gap_s())) add(segment);
    add_gaps();
    summarise();
    return std::move(result_);
  }

 private:
  double longest_gap_s() const {
    const double countable_s = countable_share * step_s_ / std::max(clock_.wander, 1e-6);
    return std::max(std::min(countable_s, 0.5 * clock_.window.length_s), missing_periods * step_s_);
  }

  void add(const Segment& segment) {
    const std::size_t count = segment.end - segment.begin;
    const SegmentFit fit = fit_segment(
        std::span(device_s_).subspan(segment.begin, count),
        latest_.subspan(segment.latest_begin, segment.latest_end - segment.latest_begin), clock_, origin_);
    for (std::size_t i = 0; i < count; ++i) {
      HostTime time = origin_ + from_s(fit.time_s[i] - link_.latency_s);
      if (!segment.new_epoch && !result_.times.empty()) time = std::max(time, result_.times.back().time);
      result_.times.push_back({.time = time,
                               .uncertainty_s = static_cast<float>(fit.uncertainty_s[i]),
                               .earlier_s = static_cast<float>(fit.earlier_s[i]),
                               .later_s = static_cast<float>(fit.later_s[i])});
    }
    if (segment.begin == 0 || segment.new_epoch) begin_epoch(segment);
    late_s_.insert(late_s_.end(), fit.late_s.begin(), fit.late_s.end());
    strays_ = strays_ || has_stray_span(latest_.subspan(segment.latest_begin, fit.late_s.size()), fit.late_s,
                                        link_.largest_constant_delay_s);
    auto& knots = result_.report.knots;
    knots.insert(knots.end(), fit.knots.begin(), fit.knots.end());
  }

  void begin_epoch(const Segment& segment) {
    result_.report.epochs.push_back(
        {result_.times[segment.begin].time, segment.new_epoch ? "the device's clock stepped back" : ""});
  }

  void add_gaps() {
    if (step_s_ <= 0.0) return;
    const double whole_s = longest_whole_step_s(device_s_, step_s_);
    for (std::size_t i = 1; i < device_s_.size(); ++i) {
      const double step_s = device_s_[i] - device_s_[i - 1];
      if (step_s > whole_s) add_gap(i, step_s / step_s_);
    }
  }

  /// Before message `i`, after so many steps of the device. One with a wrong time has not been away for
  /// so long: no more is missing than the host's time has room for.
  void add_gap(std::size_t i, double steps) {
    const HostTime begin = result_.times[i - 1].time;
    const HostTime end = result_.times[i].time;
    const double room = std::ceil(to_s(end - begin) / step_s_) + 1.0;
    const double whole = std::round(std::min({steps, room, most_missing}));
    if (whole > 1.0) result_.report.gaps.push_back({begin, end, static_cast<std::uint64_t>(whole) - 1});
  }

  void summarise() {
    ClockReport& report = result_.report;
    report.largest_constant_delay_s = link_.largest_constant_delay_s;
    report.latency_s = link_.latency_s;
    report.latency_uncertainty_s = link_.latency_uncertainty_s;
    if (late_s_.empty() || result_.times.size() < 2) return;
    report.method = "one-way";
    summarise_rate(report);
    summarise_lateness(late_s_, report);
    summarise_bounds(report);
  }

  void summarise_rate(ClockReport& report) const {
    if (report.knots.empty()) return;
    summarise_skew(report);
    if (step_s_ > 0.0) report.rate_hz = 1.0 / (step_s_ * (1.0 + report.skew_ppm * 1e-6));
  }

  void summarise_bounds(ClockReport& report) const {
    std::vector<double> widths;
    std::vector<double> uncertainties;
    for (const TimeEstimate& time : result_.times) {
      widths.push_back(1e6 * (static_cast<double>(time.earlier_s) + static_cast<double>(time.later_s)));
      uncertainties.push_back(1e6 * static_cast<double>(time.uncertainty_s));
    }
    report.bound_us = *std::max_element(widths.begin(), widths.end());
    report.bound_median_us = lower_quantile(widths, 0.5);
    report.uncertainty_us = lower_quantile(uncertainties, 0.5);
  }

  std::vector<double> device_s_;
  std::span<const LatestBegin> latest_;
  const PortProfile& link_;
  double step_s_;  // median of the device's clock between messages
  DeviceClock clock_;
  HostTime origin_{};
  std::vector<double> late_s_;
  bool strays_ = false;
  ArrivalClock result_;
};
}  // namespace

ArrivalClock fit_arrivals(std::span<const double> device_s, std::span<const LatestBegin> latest,
                          const PortProfile& link, double nominal_rate_hz) {
  PortProfile wider = link;
  for (;; wider.wander_ppm *= 2.0) {
    ArrivalFit fit(device_s, latest, wider, nominal_rate_hz);
    ArrivalClock clock = fit.run();
    const bool is_allowed = wider.wander_ppm > 0.0;  // not a number, and nothing, are doubled in vain
    clock.report.bound_wander_ppm = fit.strays() || !is_allowed ? 0.0 : wider.wander_ppm;
    clock.report.needed_wander_ppm = !is_allowed    ? 0.0
                                     : fit.strays() ? std::numeric_limits<double>::infinity()
                                                    : wider.wander_ppm;
    if (!fit.strays() || !is_allowed || !(2.0 * wider.wander_ppm <= largest_wander_ppm)) return clock;
  }
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "clock_summary.h"
#include "segment_fit.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/timing/arrivals.h"

namespace thermorig::timing {

namespace {

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

  /// Before message `i`, after so many steps of the device. One that tells a wrong time has not been away for
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

}  // namespace thermorig::timing

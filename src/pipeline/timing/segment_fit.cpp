// SPDX-License-Identifier: MIT
#include "segment_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "least_lateness.h"
#include "lower_line.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/timing/link_timing.h"

namespace thermorig::timing {

namespace {
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
    std::vector<double> places;
    for (const Ceiling& ceiling : ceilings_) places.push_back(ceiling.x);
    return least_lateness(latest_, places, fit_.late_s, device_.step_s, curve.knots(), device_.window);
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
}  // namespace

SegmentFit fit_segment(std::span<const double> device_s, std::span<const LatestBegin> latest,
                       const DeviceClock& device, HostTime origin) {
  return SegmentFitting(device_s, latest, device, origin).run();
}

}  // namespace thermorig::timing

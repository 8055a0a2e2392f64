// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/command_track.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/labels/label_config.h"

namespace thermorig::labels {

namespace {
/// Coming to rest is a ramp like any other: how every leg ends. A stop by the firmware itself carries a
/// fault.
bool is_able(const ServoState& state) {
  return state.fault == ServoFault::none && state.motion != ServoMotion::disarmed;
}

constexpr std::int64_t longest_constant_us = 5'000'000;
constexpr std::size_t least_pulses = 5;
}  // namespace

CommandTrack::CommandTrack(const PulseScale& scale, HostDuration gap, HostDuration length)
    : scale_(scale), gap_(gap), check_(scale), points_(length), pulses_(length) {}

void CommandTrack::add(const TimedServo& servo, std::span<const Pulse> pulses) {
  for (const Pulse& pulse : pulses) pulses_.add({pulse.end, pulse.start_us, pulse.value});
  constant_.reset();
  points_.add({.time = servo.stamp.time,
               .mcu_time_us = servo.mcu_time_us,
               .rate_dps = servo.state.rate_dps,
               .angle_deg = servo.state.angle_deg,
               .uncertainty_s = servo.stamp.uncertainty_s,
               .leg = servo.state.leg,
               .able = is_able(servo.state),
               .resting = is_at_rest(servo.state),
               .disagrees = check_.disagrees(servo)});
}

/// From the last point at or before `begin` to the first at or after `end`, as far as there are any; the
/// nearest one where all lie on one side.
std::span<const CommandTrack::Point> CommandTrack::around(HostTime begin, HostTime end) const {
  const auto points = points_.all();
  if (points.empty()) return points;
  const std::size_t first = std::max<std::size_t>(points_.first_after(begin), 1) - 1;
  const std::size_t last = std::min(points_.first_at_or_after(end), points.size() - 1);
  return points.subspan(first, std::max(first, last) - first + 1);
}

bool CommandTrack::is_gap(const Point& before, const Point& after) const {
  return std::chrono::microseconds(after.mcu_time_us - before.mcu_time_us) > gap_;
}

bool CommandTrack::covers(std::span<const Point> points, HostTime begin, HostTime end) const {
  if (points.empty() || points.front().time > begin || points.back().time < end) return false;
  const auto gap = [this](const Point& before, const Point& after) { return is_gap(before, after); };
  return std::adjacent_find(points.begin(), points.end(), gap) == points.end();
}

/// Straight between the points on either side, constant beyond the first and the last. There must be a point.
CommandTrack::Motion CommandTrack::at(HostTime time) const {
  const auto points = points_.all();
  const std::size_t after = points_.first_after(time);
  if (after == 0) return {points.front().rate_dps, points.front().angle_deg};
  const Point& point = points[after - 1];
  if (after == points.size()) return {point.rate_dps, point.angle_deg};
  const Point& next = points[after];
  const double share = to_s(time - point.time) / to_s(next.time - point.time);
  return {point.rate_dps + share * (next.rate_dps - point.rate_dps),
          point.angle_deg + share * (next.angle_deg - point.angle_deg)};
}

CommandSpan CommandTrack::over(HostTime begin, HostTime end) const {
  const auto points = around(begin, end);
  CommandSpan span;
  span.covered = covers(points, begin, end);
  std::uint16_t leg = 0;
  span.outside_leg = points.empty();
  for (const Point& point : points) {
    span.able = span.able && point.able;
    span.disagrees = span.disagrees || point.disagrees;
    span.time_uncertainty_s = std::max(span.time_uncertainty_s, point.uncertainty_s);
    span.outside_leg = span.outside_leg || point.leg == 0;
    span.several_legs = span.several_legs || (leg != 0 && point.leg != 0 && point.leg != leg);
    if (point.leg != 0) leg = point.leg;
  }
  return span;
}

bool CommandTrack::rests(HostTime begin, HostTime end) const {
  const auto points = around(begin, end);
  const bool is_still =
      std::all_of(points.begin(), points.end(), [](const Point& point) { return point.resting; });
  return is_still && covers(points, begin, end);
}

std::optional<double> CommandTrack::mean_rate_dps(HostTime begin, HostTime end) const {
  const auto points = around(begin, end);
  if (!covers(points, begin, end)) return std::nullopt;
  const double last_dps = at(end).rate_dps;
  if (begin == end) return last_dps;
  HostTime before = begin;
  double before_dps = at(begin).rate_dps, integral_deg = 0.0;
  const auto step_to = [&](HostTime time, double rate_dps) {
    integral_deg += 0.5 * (before_dps + rate_dps) * to_s(time - before);
    before = time;
    before_dps = rate_dps;
  };
  for (const Point& point : points)
    if (begin < point.time && point.time < end) step_to(point.time, point.rate_dps);
  step_to(end, last_dps);
  return integral_deg / to_s(end - begin);
}

double CommandTrack::farthest_deg(HostTime begin, HostTime end) const {
  const auto points = around(begin, end);
  if (points.empty()) return std::numeric_limits<double>::quiet_NaN();
  double farthest = std::max(std::abs(at(begin).angle_deg), std::abs(at(end).angle_deg));
  for (const Point& point : points)
    if (begin < point.time && point.time < end) farthest = std::max(farthest, std::abs(point.angle_deg));
  return farthest;
}

/// How far back the speed of a point is that of the ones before it.
std::int64_t CommandTrack::constant_begin_us(const Point& last) const {
  const Point* point = &last;
  const std::int64_t earliest_us = last.mcu_time_us - longest_constant_us;
  while (point != points_.all().data() && point[-1].mcu_time_us > earliest_us && !is_gap(point[-1], *point) &&
         std::abs(point[-1].rate_dps - last.rate_dps) <= constant_dps)
    --point;
  return point->mcu_time_us;
}

/// Of the pulses that start in the span.
std::optional<double> CommandTrack::pulse_rate_dps(std::int64_t begin_us, std::int64_t end_us) const {
  LineFit line;
  const auto pulses = pulses_.all();
  for (std::size_t i = pulses.size(); i-- > 0 && pulses[i].start_us >= begin_us;) {
    if (pulses[i].start_us > end_us) continue;
    line.add(static_cast<double>(pulses[i].start_us - end_us) * 1e-6, pulses[i].value);
  }
  if (line.weights() < static_cast<double>(least_pulses)) return std::nullopt;
  return scale_.continuous() ? line.mean_y() : line.slope();
}

std::optional<double> CommandTrack::constant_rate_dps(HostTime begin, HostTime end) const {
  const auto points = around(begin, end);
  if (!covers(points, begin, end)) return std::nullopt;
  const Point& last = points.back();
  if (!constant_ || constant_->until != last.time) {
    const std::int64_t begin_us = constant_begin_us(last);
    // The first pulses at a speed may still show the speed before it.
    const auto rate_dps = pulse_rate_dps(begin_us + PulseTrain::period_us, last.mcu_time_us);
    constant_ = Constant{last.time, begin_us, rate_dps};
  }
  return constant_->begin_us > points.front().mcu_time_us ? std::nullopt : constant_->rate_dps;
}

double CommandTrack::angle_deg(HostTime time) const {
  return covers(around(time, time), time, time) ? at(time).angle_deg
                                                : std::numeric_limits<double>::quiet_NaN();
}

std::uint16_t CommandTrack::leg(HostTime time) const {
  const auto points = points_.all();
  const std::size_t after = points_.first_after(time);
  if (after == 0) return 0;
  const Point& point = points[after - 1];
  const bool known = after < points.size() ? !is_gap(point, points[after]) : time - point.time <= gap_;
  return known ? point.leg : std::uint16_t{0};
}

}  // namespace thermorig::labels

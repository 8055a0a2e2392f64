// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/shaft_track.h"

#include <algorithm>
#include <limits>

#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

namespace {
constexpr HostDuration stride = std::chrono::milliseconds(4);  // of the running means
constexpr std::size_t pulse_strides = pulse_period / stride;
constexpr std::size_t slow_pulses = 5;
}  // namespace

ShaftTrack::ShaftTrack(const ServoProfile& servo, const ServoResponse& response, HostDuration gap,
                       HostDuration length)
    : scale_(servo),
      scale_of_shaft_(response.scale.value),
      slope_(response.gain, response.ripples, scale_),
      delay_(from_s(response.delay_s)),
      train_(scale_, gap),
      loop_(scale_.continuous(), response.loop_hz, response.dead_band_deg),
      points_(length) {}

std::span<const Pulse> ShaftTrack::add(const TimedServo& servo) {
  new_pulses_.clear();
  train_.add(servo, new_pulses_);
  pulses_.insert(pulses_.end(), new_pulses_.begin(), new_pulses_.end());
  auto ended = pulses_.begin();
  for (; ended != pulses_.end() && ended->end <= servo.stamp.time; ++ended) take(*ended);
  pulses_.erase(pulses_.begin(), ended);
  if (started_) advance(servo.stamp.time);
  return new_pulses_;
}

void ShaftTrack::take(const Pulse& pulse) {
  if (started_) advance(pulse.end);
  if (!started_ || pulse.restart) {
    now_ = started_ ? std::max(now_, pulse.end) : pulse.end;
    loop_.restart(pulse.value, pulse.rate_dps);
    last_angle_deg_ = loop_.angle_deg();
  }
  value_ = pulse.value;
  if (!started_) add_point(now_);
  started_ = true;
}

void ShaftTrack::advance(HostTime until) {
  if (until <= now_) return;
  HostTime time = now_;
  loop_.advance(value_, to_s(until - now_), [&](double step_s) {
    time += from_s(step_s);
    add_point(time);
  });
  now_ = until;
}

double ShaftTrack::slope_at(double angle_deg, bool forward) const {
  return scale_of_shaft_ * (scale_.continuous() ? slope_.gain(value_) : slope_.at(angle_deg, forward));
}

void ShaftTrack::add_point(HostTime time) {
  const double angle_deg = loop_.angle_deg();
  const bool forward = loop_.rate_dps() > 0.0;
  const double slope = slope_at(angle_deg, forward);
  const double on_the_way = slope_at((angle_deg + last_angle_deg_) / 2.0, forward);
  scaled_deg_ += on_the_way * (angle_deg - last_angle_deg_);
  last_angle_deg_ = angle_deg;
  points_.add({time + delay_, angle_deg, loop_.rate_dps(), scaled_deg_, slope});
}

bool ShaftTrack::covers(HostTime begin, HostTime end) const {
  return points_.reaches(end) && points_.all().front().time <= begin;
}

ShaftAngle ShaftTrack::between(std::size_t after, HostTime time) const {
  const auto points = points_.all();
  if (after == 0) return {points.front().angle_deg, points.front().scaled_deg};
  if (after == points.size()) return {points.back().angle_deg, points.back().scaled_deg};
  const Point& a = points[after - 1];
  const Point& b = points[after];
  const double length_s = to_s(b.time - a.time);
  const double share = to_s(time - a.time) / length_s;
  return {hermite(a.angle_deg, a.rate_dps, b.angle_deg, b.rate_dps, length_s, share),
          hermite(a.scaled_deg, a.slope * a.rate_dps, b.scaled_deg, b.slope * b.rate_dps, length_s, share)};
}

ShaftAngle ShaftTrack::at(HostTime time) const {
  return between(points_.first_after(time), time);
}

double ShaftTrack::mean_dps(HostTime begin, HostTime end) const {
  return (at(end).scaled_deg - at(begin).scaled_deg) / to_s(end - begin);
}

/// Every `stride` from `begin` on, not beyond `end`.
std::vector<ShaftAngle> ShaftTrack::strides(HostTime begin, HostTime end) const {
  const auto points = points_.all();
  std::vector<ShaftAngle> angles;
  angles.reserve(static_cast<std::size_t>((end - begin) / stride) + 1);
  std::size_t after = points_.first_after(begin);
  for (HostTime time = begin; time <= end; time += stride) {
    while (after < points.size() && points[after].time <= time) ++after;
    angles.push_back(between(after, time));
  }
  return angles;
}

ShaftTrack::Ranges ShaftTrack::ranges(const std::vector<ShaftAngle>& angles, std::size_t window) {
  constexpr double most = std::numeric_limits<double>::infinity();
  Ranges ranges{{most, -most}, {most, -most}};
  const auto widen = [](RateRange& range, double rate_dps) {
    range = {std::min(range.min_dps, rate_dps), std::max(range.max_dps, rate_dps)};
  };
  const std::size_t strides = std::min(window, angles.size() - 1);
  const double length_s = to_s(stride) * static_cast<double>(strides);
  for (std::size_t to = strides; strides > 0 && to < angles.size(); ++to) {
    const ShaftAngle &last = angles[to], &before = angles[to - strides];
    widen(ranges.scaled, (last.scaled_deg - before.scaled_deg) / length_s);
    widen(ranges.plain, (last.plain_deg - before.plain_deg) / length_s);
  }
  return ranges;
}

ShaftRates ShaftTrack::over(HostTime begin, HostTime end) const {
  const std::vector<ShaftAngle> angles = strides(begin, end);
  const double mean = mean_dps(begin, end);
  const RateRange range = ranges(angles, pulse_strides).scaled;
  const Ranges slow = ranges(angles, slow_pulses * pulse_strides);
  return {.mean_dps = mean,
          .range = {std::min(range.min_dps, mean), std::max(range.max_dps, mean)},
          .slow = slow.scaled,
          .plain_slow = slow.plain};
}

}  // namespace thermorig::labels

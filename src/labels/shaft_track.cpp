// SPDX-License-Identifier: MIT
#include "thermorig/labels/shaft_track.h"

#include <algorithm>

#include "hermite.h"
#include "thermorig/labels/shaft_model.h"

namespace thermorig::labels {

namespace {
constexpr HostDuration pulse_period = std::chrono::microseconds(PulseTrain::period_us);
constexpr HostDuration stride = std::chrono::milliseconds(4);  // of the running mean
}  // namespace

ShaftTrack::ShaftTrack(const ServoProfile& servo, const ServoResponse& response, HostDuration gap,
                       HostDuration length)
    : scale_(servo),
      response_(response),
      delay_(from_s(response.delay_s)),
      train_(scale_, gap),
      loop_(scale_.continuous(), response.loop_hz, response.dead_band_deg),
      points_(length) {}

void ShaftTrack::add(const TimedServo& servo) {
  train_.add(servo, pulses_);
  auto ended = pulses_.begin();
  for (; ended != pulses_.end() && ended->end <= servo.stamp.time; ++ended) take(*ended);
  pulses_.erase(pulses_.begin(), ended);
  if (started_) advance(servo.stamp.time);
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

void ShaftTrack::add_point(HostTime time) {
  const double angle_deg = loop_.angle_deg();
  const double slope =
      response_.scale.value * gain_at(response_, scale_, scale_.continuous() ? value_ : angle_deg);
  scaled_deg_ += slope * (angle_deg - last_angle_deg_);
  last_angle_deg_ = angle_deg;
  points_.add({time + delay_, angle_deg, loop_.rate_dps(), scaled_deg_, slope});
}

bool ShaftTrack::covers(HostTime begin, HostTime end) const {
  return points_.reaches(end) && points_.all().front().time <= begin;
}

ShaftAngle ShaftTrack::at(HostTime time) const {
  const auto points = points_.all();
  const std::size_t after = points_.first_after(time);
  if (after == 0) return {points.front().angle_deg, points.front().scaled_deg};
  if (after == points.size()) return {points.back().angle_deg, points.back().scaled_deg};
  const Point& a = points[after - 1];
  const Point& b = points[after];
  const double length_s = to_s(b.time - a.time);
  const double share = to_s(time - a.time) / length_s;
  return {hermite(a.angle_deg, a.rate_dps, b.angle_deg, b.rate_dps, length_s, share),
          hermite(a.scaled_deg, a.slope * a.rate_dps, b.scaled_deg, b.slope * b.rate_dps, length_s, share)};
}

double ShaftTrack::mean_dps(HostTime begin, HostTime end) const {
  return (at(end).scaled_deg - at(begin).scaled_deg) / to_s(end - begin);
}

ShaftRates ShaftTrack::over(HostTime begin, HostTime end) const {
  ShaftRates rates;
  rates.mean_dps = mean_dps(begin, end);
  const HostDuration window = std::min(pulse_period, end - begin);
  bool first = true;
  for (HostTime to = begin + window; to <= end; to += stride) {
    const ShaftAngle last = at(to), before = at(to - window);
    const double plain_dps = (last.plain_deg - before.plain_deg) / to_s(window);
    const double scaled_dps = (last.scaled_deg - before.scaled_deg) / to_s(window);
    rates.min_dps = first ? scaled_dps : std::min(rates.min_dps, scaled_dps);
    rates.max_dps = first ? scaled_dps : std::max(rates.max_dps, scaled_dps);
    rates.plain_min_dps = first ? plain_dps : std::min(rates.plain_min_dps, plain_dps);
    rates.plain_max_dps = first ? plain_dps : std::max(rates.plain_max_dps, plain_dps);
    first = false;
  }
  return rates;
}

}  // namespace thermorig::labels

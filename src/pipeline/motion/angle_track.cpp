// SPDX-License-Identifier: MIT
#include "angle_track.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "thermorig/core/statistics.h"

namespace thermorig::motion {
namespace {

/// A rate may change unseen in a gap: at 2000 deg/s2, what a lost 40 ms can hide is a degree and a half.
constexpr double shortest_gap_s = 0.04;
constexpr double gap_periods = 3.5;
constexpr std::ptrdiff_t near_knots = 32;

}  // namespace

AngleTrack::AngleTrack(std::span<const TimedGyro> gyro) {
  if (gyro.empty()) return;
  origin_ = gyro.front().stamp.time;
  knots_.reserve(gyro.size());
  for (const TimedGyro& sample : gyro)
    if (is_rate(sample.rate_dps))
      append(to_s(sample.stamp.time - origin_), static_cast<double>(sample.rate_dps));
  number_stretches();
}

/// A sample stands for the instant of its stamp; between two the rate is a straight line.
void AngleTrack::append(double time_s, double rate_dps) {
  if (knots_.empty()) {
    knots_.push_back({time_s, rate_dps, 0.0, 0.0, 0});
    return;
  }
  const Knot& last = knots_.back();
  const double step_s = time_s - last.time_s;
  if (step_s <= 0.0) return;
  const double angle_deg = last.angle_deg + 0.5 * (last.rate_dps + rate_dps) * step_s;
  const double integral = last.angle_integral_s + 0.5 * (last.angle_deg + angle_deg) * step_s;
  knots_.push_back({time_s, rate_dps, angle_deg, integral, 0});
}

void AngleTrack::number_stretches() {
  if (knots_.size() < 2) return;
  std::vector<double> steps_s;
  steps_s.reserve(knots_.size() - 1);
  for (std::size_t i = 1; i < knots_.size(); ++i) steps_s.push_back(knots_[i].time_s - knots_[i - 1].time_s);
  const double gap_s = std::max(shortest_gap_s, gap_periods * reordering_median(steps_s));
  for (std::size_t i = 1; i < knots_.size(); ++i)
    knots_[i].stretch = knots_[i - 1].stretch + (knots_[i].time_s - knots_[i - 1].time_s > gap_s ? 1 : 0);
}

/// Samples come evenly: the knot lies where it should, or all are searched.
std::size_t AngleTrack::knot_before(double time_s) const {
  const auto later = [](double time, const Knot& knot) { return time < knot.time_s; };
  const double most = static_cast<double>(knots_.size() - 1);
  const double length_s = knots_.back().time_s - knots_.front().time_s;
  const double place = std::clamp((time_s - knots_.front().time_s) / length_s * most, 0.0, most);
  const auto middle = static_cast<std::ptrdiff_t>(std::isfinite(place) ? place : 0.0);
  const auto count = static_cast<std::ptrdiff_t>(knots_.size());
  auto first = knots_.begin() + std::max<std::ptrdiff_t>(middle - near_knots, 0);
  auto last = knots_.begin() + std::min(middle + near_knots, count);
  if (first->time_s > time_s || !((last - 1)->time_s > time_s)) {
    first = knots_.begin();
    last = knots_.end();
  }
  const auto after = std::upper_bound(first, last, time_s, later);
  return after == knots_.begin() ? 0 : static_cast<std::size_t>(after - knots_.begin()) - 1;
}

AngleTrack::Integrals AngleTrack::at(double time_s) const {
  const std::size_t i = knot_before(time_s);
  const Knot& left = knots_[i];
  const double since_s = time_s - left.time_s;
  if (since_s <= 0.0 || i + 1 == knots_.size())
    return {left.angle_deg, left.angle_integral_s + left.angle_deg * since_s};
  const Knot& right = knots_[i + 1];
  const double part = since_s / (right.time_s - left.time_s);
  const double angle_deg = std::lerp(left.angle_deg, right.angle_deg, part);
  return {angle_deg, left.angle_integral_s + 0.5 * (left.angle_deg + angle_deg) * since_s};
}

AngleTrack::Mean AngleTrack::over(double begin_s, double end_s) const {
  const Integrals begin = at(begin_s);
  const Integrals end = at(end_s);
  const double duration_s = end_s - begin_s;
  return {(end.angle_integral_s - begin.angle_integral_s) / duration_s,
          (end.angle_deg - begin.angle_deg) / duration_s};
}

double AngleTrack::mean_rate_dps() const {
  return knots_.size() < 2 ? 0.0 : over(knots_.front().time_s, knots_.back().time_s).rate_dps;
}

std::optional<int> AngleTrack::stretch(double begin_s, double end_s) const {
  if (knots_.empty() || begin_s < knots_.front().time_s || end_s > knots_.back().time_s) return std::nullopt;
  const int first = knots_[knot_before(begin_s)].stretch;
  const std::size_t last = knot_before(end_s);
  const bool inside = knots_[last].time_s < end_s && last + 1 < knots_.size();
  if (knots_[inside ? last + 1 : last].stretch != first) return std::nullopt;
  return first;
}

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#include "gyro_integral.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/estimate.h"
#include "thermorig/core/statistics.h"

namespace thermorig::fit {

namespace {
constexpr double hole_periods = 2.5;

std::vector<double> seconds(std::span<const TimedGyro> gyro, HostTime origin) {
  std::vector<double> times;
  times.reserve(gyro.size());
  for (const TimedGyro& sample : gyro) {
    const double time_s = to_s(sample.stamp.time - origin);
    times.push_back(times.empty() ? time_s : std::max(time_s, times.back()));
  }
  return times;
}

double median_step(const std::vector<double>& times) {
  std::vector<double> steps;
  steps.reserve(times.size());
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  return median(std::move(steps));
}
}  // namespace

GyroIntegral::GyroIntegral(std::span<const TimedGyro> gyro, const GyroErrors& errors, HostTime origin,
                           Saturated saturated)
    : times_s_(seconds(gyro, origin)), period_s_(median_step(times_s_)) {
  if (times_s_.empty()) return;
  const double bias_dps = errors.bias_dps ? errors.bias_dps->value : 0.0;
  const double scale = errors.scale.value > 0.0 ? errors.scale.value : 1.0;
  edges_.reserve(times_s_.size() + 1);
  edges_.push_back({times_s_.front() - period_s_ / 2.0, 0.0, 0});
  for (std::size_t i = 0; i < times_s_.size(); ++i) {
    const bool last = i + 1 == times_s_.size();
    const double end_s = last ? times_s_[i] + period_s_ / 2.0 : (times_s_[i] + times_s_[i + 1]) / 2.0;
    const double length_s = end_s - edges_.back().time_s;
    const double rate_dps = (static_cast<double>(gyro[i].rate_dps) - bias_dps) / scale;
    const bool finite = std::isfinite(rate_dps);
    const bool spoilt = gyro[i].reading.saturated && saturated == Saturated::spoils;
    const bool bad = spoilt || !finite || length_s > hole_periods * period_s_;
    edges_.push_back({end_s, edges_.back().angle_deg + (finite ? rate_dps * length_s : 0.0),
                      edges_.back().bad + (bad ? 1U : 0U)});
  }
}

double GyroIntegral::angle_deg(std::size_t edge, double time_s) const {
  const Edge& left = edges_[edge];
  if (edge + 1 == edges_.size()) return left.angle_deg;
  const Edge& right = edges_[edge + 1];
  return std::lerp(left.angle_deg, right.angle_deg, (time_s - left.time_s) / (right.time_s - left.time_s));
}

double GyroIntegral::mean_dps(double begin_s, double end_s, std::size_t& near) const {
  if (edges_.empty() || begin_s < edges_.front().time_s || end_s > edges_.back().time_s) return unknown;
  const std::size_t first = first_after(edges_, begin_s, near) - 1;
  const std::size_t last = first_after(edges_, end_s, near) - 1;
  const std::size_t through = std::min(last + 1, edges_.size() - 1);
  if (edges_[through].bad != edges_[first].bad) return unknown;
  return (angle_deg(last, end_s) - angle_deg(first, begin_s)) / (end_s - begin_s);
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"

namespace thermorig::fit {

/// Index of the first point whose `time_s` is later; that many points if none is. `near` is where the search
/// before this one ended, and becomes where this one ends: times that follow one another are found in a few
/// steps. It need not be an index that exists.
template <typename Point>
std::size_t first_after(const std::vector<Point>& points, double time_s, std::size_t& near) {
  constexpr std::size_t most_steps = 16;
  const std::size_t from = std::min(near, points.size());
  const std::size_t last = std::min(points.size(), from + most_steps);
  const std::size_t first = from - std::min(from, most_steps);
  near = from;
  while (near < last && !(time_s < points[near].time_s)) ++near;
  while (near > first && time_s < points[near - 1].time_s) --near;
  const bool is_within = (near > first || first == 0) && (near < last || last == points.size());
  if (is_within) return near;
  const auto is_earlier = [](double time, const Point& point) { return time < point.time_s; };
  near = static_cast<std::size_t>(std::upper_bound(points.begin(), points.end(), time_s, is_earlier) -
                                  points.begin());
  return near;
}

/// The angle that the corrected gyro has turned by, over a whole recording. Each sample stands for the time
/// up to halfway to its neighbours.
class GyroIntegral {
 public:
  /// Whether a mean over saturated samples is a number: the least that the rate can be.
  enum class Saturated : std::uint8_t { spoils, counts };

  /// Times count in seconds from `origin`. Saturated samples and holes are remembered.
  GyroIntegral(std::span<const TimedGyro> gyro, const GyroErrors& errors, HostTime origin,
               Saturated saturated = Saturated::spoils);

  /// Mean rate over [begin_s, end_s], begin_s < end_s; not a number where a sample is missing or saturated or
  /// the recording does not reach.
  double mean_dps(double begin_s, double end_s) const {
    std::size_t near = 0;
    return mean_dps(begin_s, end_s, near);
  }
  /// `near`: see first_after().
  double mean_dps(double begin_s, double end_s, std::size_t& near) const;

  /// Median time between samples; 0 if there are fewer than two.
  double period_s() const { return period_s_; }
  const std::vector<double>& times_s() const { return times_s_; }

 private:
  struct Edge {
    double time_s;
    double angle_deg;
    std::uint32_t bad;  // bad samples so far
  };
  double angle_deg(std::size_t edge, double time_s) const;

  std::vector<double> times_s_;
  std::vector<Edge> edges_;
  double period_s_ = 0.0;
};

}  // namespace thermorig::fit

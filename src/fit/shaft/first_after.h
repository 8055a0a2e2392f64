// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

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

}  // namespace thermorig::fit

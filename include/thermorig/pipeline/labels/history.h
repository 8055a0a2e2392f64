// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/core/time.h"

namespace thermorig::labels {

/// The points of one stream over the last few seconds, in time order and contiguous in memory.
/// `Point` has a member `HostTime time`. Adding and forgetting cost O(1) amortised.
template <typename Point>
class History {
 public:
  /// Points older than `length` before the newest are forgotten.
  explicit History(HostDuration length) : length_(length) {}

  /// A point that is earlier than the one before it counts as simultaneous with it.
  void add(Point point) {
    if (!points_.empty()) point.time = std::max(point.time, points_.back().time);
    points_.push_back(point);
    while (points_[first_].time < point.time - length_) ++first_;
    if (first_ > points_.size() / 2) forget();
  }

  /// The last point of all(), of which there must be one. Its time stays.
  Point& newest() { return points_.back(); }

  /// True if a point at or after `time` has come.
  bool reaches(HostTime time) const { return !points_.empty() && points_.back().time >= time; }

  std::span<const Point> all() const { return std::span(points_).subspan(first_); }

  /// Index into all() of the first point at or after `time`.
  std::size_t first_at_or_after(HostTime time) const {
    const auto points = all();
    const auto before = [](const Point& point, HostTime t) { return point.time < t; };
    return std::lower_bound(points.begin(), points.end(), time, before) - points.begin();
  }

  /// Index into all() of the first point after `time`.
  std::size_t first_after(HostTime time) const {
    const auto points = all();
    const auto after = [](HostTime t, const Point& point) { return t < point.time; };
    return std::upper_bound(points.begin(), points.end(), time, after) - points.begin();
  }

 private:
  void forget() {
    points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
  }

  HostDuration length_;
  std::vector<Point> points_;
  std::size_t first_ = 0;  // points before it are forgotten
};

}  // namespace thermorig::labels

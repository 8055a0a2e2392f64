// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/history.h"

namespace thermorig::labels {

/// Whether the camera has settled, by its own temperature (Ta): least-squares slope over the last 30 s.
/// Frames within 0.1 s count together, so that a frame costs the same however many came at one time.
class WarmUp {
 public:
  explicit WarmUp(double limit_k_per_min) : limit_k_per_min_(limit_k_per_min), points_(length) {}

  /// True while Ta changes faster than the limit; false until 5 s of frames have come. Not a number is left
  /// out.
  bool push(HostTime time, float sensor_temp_c) {
    if (!std::isfinite(sensor_temp_c)) return false;
    const auto temp_c = static_cast<double>(sensor_temp_c);
    if (!points_.all().empty() && time - points_.newest().time < together)
      points_.newest().add(std::max(0.0, to_s(time - points_.newest().time)), temp_c);
    else
      points_.add({.time = time, .temp_c = temp_c});
    const auto points = points_.all();
    if (points.back().time - points.front().time < least_length) return false;
    LineFit line;
    for (const Point& point : points)
      line.add(to_s(point.time - points.front().time) + point.after_s, point.temp_c, point.count);
    return std::abs(line.slope()) * 60.0 > limit_k_per_min_;
  }

 private:
  static constexpr HostDuration length = std::chrono::seconds(30);
  static constexpr HostDuration least_length = std::chrono::seconds(5);
  static constexpr HostDuration together = std::chrono::milliseconds(100);
  struct Point {
    HostTime time{};       // of the first frame
    double count = 1.0;    // frames, and their means:
    double after_s = 0.0;  // time since the first
    double temp_c = 0.0;

    void add(double frame_after_s, double frame_temp_c) {
      count += 1.0;
      after_s += (frame_after_s - after_s) / count;
      temp_c += (frame_temp_c - temp_c) / count;
    }
  };

  double limit_k_per_min_;
  History<Point> points_;
};

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/warm_up.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

void WarmUp::Point::add(double frame_after_s, double frame_temp_c) {
  count += 1.0;
  after_s += (frame_after_s - after_s) / count;
  temp_c += (frame_temp_c - temp_c) / count;
}

double WarmUp::slope_k_per_s() const {
  LineFit line;
  const auto points = points_.all();
  for (const Point& point : points)
    line.add(to_s(point.time - points.front().time) + point.after_s, point.temp_c, point.count);
  return line.slope();
}

bool WarmUp::push(HostTime time, float sensor_temp_c) {
  if (!std::isfinite(sensor_temp_c)) return false;
  const auto temp_c = static_cast<double>(sensor_temp_c);
  if (!points_.all().empty() && time - points_.newest().time < together)
    points_.newest().add(std::max(0.0, to_s(time - points_.newest().time)), temp_c);
  else
    points_.add({.time = time, .temp_c = temp_c});
  if (points_.all().back().time - points_.all().front().time < least_length) return false;
  return std::abs(slope_k_per_s()) * 60.0 > limit_k_per_min_;
}

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "thermorig/labels/warm_up.h"

#include <cmath>

namespace thermorig::labels {

double WarmUp::slope_k_per_s() const {
  const auto points = points_.all();
  double mean_s = 0.0, mean_c = 0.0, product = 0.0, square = 0.0;
  for (const Point& point : points) {
    mean_s += to_s(point.time - points.front().time) / static_cast<double>(points.size());
    mean_c += point.temp_c / static_cast<double>(points.size());
  }
  for (const Point& point : points) {
    const double off_s = to_s(point.time - points.front().time) - mean_s;
    product += off_s * (point.temp_c - mean_c);
    square += off_s * off_s;
  }
  return square > 0.0 ? product / square : 0.0;
}

bool WarmUp::push(HostTime time, float sensor_temp_c) {
  if (!std::isfinite(sensor_temp_c)) return false;
  points_.add({time, static_cast<double>(sensor_temp_c)});
  if (points_.all().back().time - points_.all().front().time < least_length) return false;
  return std::abs(slope_k_per_s()) * 60.0 > limit_k_per_min_;
}

}  // namespace thermorig::labels

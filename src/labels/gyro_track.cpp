// SPDX-License-Identifier: MIT
#include "thermorig/labels/gyro_track.h"

namespace thermorig::labels {

GyroMean GyroTrack::over(HostTime begin, HostTime end) const {
  const auto points = points_.all();
  GyroMean mean;
  double sum_dps = 0.0;
  for (std::size_t i = points_.first_at_or_after(begin); i < points.size() && points[i].time < end; ++i) {
    sum_dps += points[i].rate_dps;
    ++mean.count;
  }
  if (mean.count > 0) mean.rate_dps = sum_dps / static_cast<double>(mean.count);
  return mean;
}

}  // namespace thermorig::labels

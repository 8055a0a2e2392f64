// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/labels/history.h"

namespace thermorig::labels {

struct GyroMean {
  double rate_dps = std::numeric_limits<double>::quiet_NaN();  // NaN if there is no sample
  std::size_t count = 0;
};

/// The gyro's rate about the servo's axis over the last few seconds.
class GyroTrack {
 public:
  /// Samples older than `length` are forgotten.
  explicit GyroTrack(HostDuration length) : points_(length) {}

  void add(const TimedGyro& gyro) { points_.add({gyro.stamp.time, gyro.rate_dps}); }

  /// True if a sample at or after `time` has come.
  bool reaches(HostTime time) const { return points_.reaches(time); }

  /// Mean of the samples with begin <= time < end.
  GyroMean over(HostTime begin, HostTime end) const;

 private:
  struct Point {
    HostTime time{};
    float rate_dps = 0.0F;
  };
  History<Point> points_;
};

}  // namespace thermorig::labels

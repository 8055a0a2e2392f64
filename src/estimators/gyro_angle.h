// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "thermorig/core/sample.h"

namespace thermorig::estimators {

/// What a gyro has turned by since its first sample: trapezoids between neighbouring samples, also where some
/// were lost between them.
class GyroAngle {
 public:
  void add(std::span<const TimedGyro> samples) {
    for (const TimedGyro& sample : samples) add(sample);
  }

  double turned_deg() const { return turned_deg_; }  // bias not removed
  double path_deg() const { return path_deg_; }      // the same of |rate|: what an error of scale acts on
  double elapsed_s() const { return elapsed_s_; }    // from the first sample to the last
  bool has_begun() const { return last_.has_value(); }

 private:
  struct Point {
    HostTime time{};
    double rate_dps = 0.0;
  };

  void add(const TimedGyro& sample) {
    const Point point{sample.stamp.time, double{sample.rate_dps}};
    if (!std::isfinite(point.rate_dps)) return;
    if (last_ && point.time <= last_->time) return;  // a clock that began anew
    if (last_) {
      const double step_s = to_s(point.time - last_->time);
      const double rate_dps = 0.5 * (point.rate_dps + last_->rate_dps);
      turned_deg_ += rate_dps * step_s;
      path_deg_ += std::abs(rate_dps) * step_s;
      elapsed_s_ += step_s;
    }
    last_ = point;
  }

  std::optional<Point> last_;
  double turned_deg_ = 0.0, path_deg_ = 0.0, elapsed_s_ = 0.0;
};

}  // namespace thermorig::estimators

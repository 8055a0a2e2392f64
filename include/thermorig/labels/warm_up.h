// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/time.h"
#include "thermorig/labels/history.h"

namespace thermorig::labels {

/// Whether the camera has settled, by its own temperature (Ta): least-squares slope over the last 30 s.
class WarmUp {
 public:
  explicit WarmUp(double limit_k_per_min) : limit_k_per_min_(limit_k_per_min), points_(length) {}

  /// True while Ta changes faster than the limit; false until 5 s of frames have come. Not a number is left
  /// out.
  bool push(HostTime time, float sensor_temp_c);

 private:
  static constexpr HostDuration length = std::chrono::seconds(30);
  static constexpr HostDuration least_length = std::chrono::seconds(5);
  struct Point {
    HostTime time{};
    double temp_c = 0.0;
  };
  double slope_k_per_s() const;

  double limit_k_per_min_;
  History<Point> points_;
};

}  // namespace thermorig::labels

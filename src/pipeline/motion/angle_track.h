// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::motion {

/// How far the rig has turned at any instant, by the gyro as it is: no bias, no scale taken into account.
/// Means over an interval cost a look-up at either end, whatever the interval's length.
class AngleTrack {
 public:
  explicit AngleTrack(std::span<const TimedGyro> gyro);

  bool empty() const { return knots_.empty(); }

  /// Seconds since the track's first sample.
  double seconds(HostTime time) const { return to_s(time - origin_); }

  struct Mean {
    double angle_deg = 0.0;  // since the first sample
    double rate_dps = 0.0;
  };
  /// Over the interval; outside the track the angle stays what it was at its ends.
  Mean over(double begin_s, double end_s) const;

  /// Over all samples.
  double mean_rate_dps() const;

  /// Number of the unbroken stretch of samples that covers the whole interval; none where samples are
  /// missing.
  std::optional<int> stretch(double begin_s, double end_s) const;

 private:
  struct Knot {
    double time_s = 0.0;
    double rate_dps = 0.0;
    double angle_deg = 0.0;         // integral of the rate
    double angle_integral_s = 0.0;  // integral of the angle
    int stretch = 0;
  };
  struct Integrals {
    double angle_deg = 0.0;
    double angle_integral_s = 0.0;
  };
  void append(double time_s, double rate_dps);
  void number_stretches();
  Integrals at(double time_s) const;
  std::size_t knot_before(double time_s) const;

  HostTime origin_{};
  std::vector<Knot> knots_;
};

}  // namespace thermorig::motion

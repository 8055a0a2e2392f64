// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/history.h"

namespace thermorig::labels {

/// Variance of means over one pulse period each, by three that follow each other: how far the middle one lies
/// from the line between its neighbours. It hears what is faster than some 12 Hz, which is too fast to move a
/// shaft with a camera on it by a part of a pixel; pulses average out.
inline double alternation_dps2(double before_dps, double middle_dps, double after_dps) {
  const double off_dps = before_dps - 2.0 * middle_dps + after_dps;
  return off_dps * off_dps / 6.0;
}

struct GyroMean {
  double rate_dps = std::numeric_limits<double>::quiet_NaN();  // NaN if there is no sample
  std::size_t count = 0;
  double deviation_dps = 0.0;  // standard deviation of the samples
  double spread_dps = 0.0;     // the same after a running mean over one servo pulse period, 20 ms
  double least_dps = std::numeric_limits<double>::quiet_NaN();  // of that running mean; NaN: too few samples
  double most_dps = std::numeric_limits<double>::quiet_NaN();
  double averaged = 1.0;  // samples that the running mean takes together
  // Noise of a sample by what is too fast for the shaft; NaN: too few samples.
  double fast_dps = std::numeric_limits<double>::quiet_NaN();
  bool saturated = false;  // a sample at an end of the sensor's range: the mean says little
  float time_uncertainty_s = 0.0F;
};

/// Whether a sample with begin <= time < end never came: those that a gap lacks would stand evenly in it.
/// `gaps` ascend.
bool lacks_sample(std::span<const ClockGap> gaps, HostTime begin, HostTime end);

/// The gyro's rate about the servo's axis over the last few seconds.
class GyroTrack {
 public:
  /// Samples older than `length` are forgotten.
  explicit GyroTrack(HostDuration length) : points_(length) {}

  void add(const TimedGyro& gyro);

  /// True if a sample at or after `time` has come.
  bool reaches(HostTime time) const { return points_.reaches(time); }

  /// Of the samples with begin <= time < end.
  GyroMean over(HostTime begin, HostTime end) const;

  /// GyroMean::rate_dps alone.
  double mean_dps(HostTime begin, HostTime end) const;

  /// Whether a sample with begin <= time < end never came, as far as the samples tell that have come, which
  /// are due every `period_s`: a silence of ten periods is one, a shorter one may yet be a time that a clock
  /// takes back.
  bool lacks_sample(HostTime begin, HostTime end, double period_s) const;

 private:
  struct Point {
    HostTime time{};
    float rate_dps = 0.0F;
    float uncertainty_s = 0.0F;
    bool saturated = false;
  };
  std::span<const Point> between(HostTime begin, HostTime end) const;
  static void note_spread(GyroMean& mean, std::span<const Point> points);

  History<Point> points_;
};

}  // namespace thermorig::labels

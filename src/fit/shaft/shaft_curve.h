// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"

namespace thermorig::fit {

using labels::PulseScale;

/// A pulse of a whole recording, its end in seconds.
struct PulseAt {
  double end_s = 0.0;
  double value = 0.0;
  double rate_dps = 0.0;  // commanded with it
  bool restart = false;
};

/// All pulses of telemetry, in order of time. `longest_gap_s`: PulseTrain.
std::vector<PulseAt> all_pulses(std::span<const TimedServo> servo, const PulseScale& scale, HostTime origin,
                                double longest_gap_s);

/// What the loop, scale and gain 1 and no delay, makes of some pulses.
class ShaftCurve {
 public:
  /// `pulses` is not empty. The loop starts as if it had long followed the first one.
  ShaftCurve(std::span<const PulseAt> pulses, bool continuous, double loop_hz, double dead_band_deg,
             double until_s);

  /// Angle at a time; before the first and beyond the last point, that of the point.
  /// `near`: see first_after().
  double angle_deg(double time_s, std::size_t& near) const;

  /// Where an interval before began and ended.
  struct Near {
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  /// Mean rate over [begin_s, end_s].
  double mean_dps(double begin_s, double end_s, Near& near) const {
    const double begin_deg = angle_deg(begin_s, near.begin);
    return (angle_deg(end_s, near.end) - begin_deg) / (end_s - begin_s);
  }

 private:
  struct Point {
    double time_s;
    double angle_deg;
    double rate_dps;
  };
  std::vector<Point> points_;
};

}  // namespace thermorig::fit

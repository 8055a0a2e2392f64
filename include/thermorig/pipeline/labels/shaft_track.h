// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/history.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"

namespace thermorig::labels {

/// The cubic through two points with their slopes, at `share` of the way from one to the other.
inline double hermite(double from, double from_slope, double to, double to_slope, double length,
                      double share) {
  const double rest = 1.0 - share;
  const double rise = to - from;
  const double bend = rest * (from_slope * length - rise) - share * (to_slope * length - rise);
  return from + share * rise + share * rest * bend;
}

/// Where the model has the shaft.
struct ShaftAngle {
  double plain_deg = 0.0;   // scale and gain 1
  double scaled_deg = 0.0;  // scale, gain and ripples of the response
};

/// Extremes of a running mean, deg/s.
struct RateRange {
  double min_dps = 0.0;
  double max_dps = 0.0;
};

/// What the shaft did over a span by the model. Slow means are over five pulse periods: the ripple that steps
/// of the pulse width leave in a steady speed is gone from them, a ramp is not.
struct ShaftRates {
  double mean_dps = 0.0;  // over the span; scale, gain and ripples of the response
  RateRange range;        // of means over one pulse period, and of mean_dps
  RateRange slow;         // of slow means
  RateRange plain_slow;   // the same, scale and gain 1, no ripples
};

/// The shaft over the last few seconds, by the servo's response to the pulses that telemetry reports.
class ShaftTrack {
 public:
  /// `gap`: see PulseTrain. Older than `length` is forgotten.
  ShaftTrack(const ServoProfile& servo, const ServoResponse& response, HostDuration gap, HostDuration length);

  /// Returns the pulses of the message, until the next call.
  std::span<const Pulse> add(const TimedServo& servo);

  /// True if the shaft is known up to `time`.
  bool reaches(HostTime time) const { return points_.reaches(time); }

  /// True if it is known from `begin` to `end`; gaps are not looked for.
  bool covers(HostTime begin, HostTime end) const;

  /// Where covers() is true of the time, else the nearest known. There must be telemetry.
  ShaftAngle at(HostTime time) const;

  /// begin < end, covered.
  double mean_dps(HostTime begin, HostTime end) const;
  ShaftRates over(HostTime begin, HostTime end) const;

 private:
  struct Point {
    HostTime time{};
    double angle_deg = 0.0;
    double rate_dps = 0.0;
    double scaled_deg = 0.0;
    double slope = 1.0;  // scale, gain and ripples
  };
  struct Ranges {
    RateRange scaled;
    RateRange plain;
  };
  ShaftAngle between(std::size_t after, HostTime time) const;  // the points before and at `after`
  std::vector<ShaftAngle> strides(HostTime begin, HostTime end) const;
  static Ranges ranges(const std::vector<ShaftAngle>& angles, std::size_t window);
  void take(const Pulse& pulse);
  void advance(HostTime until);
  double slope_at(double angle_deg, bool forward) const;
  void add_point(HostTime time);

  PulseScale scale_;
  double scale_of_shaft_;
  ShaftSlope slope_;
  HostDuration delay_;
  PulseTrain train_;
  ServoLoop loop_;
  std::vector<Pulse> new_pulses_, pulses_;  // of the newest message; those that have not ended yet
  double value_ = 0.0;                      // commanded now
  HostTime now_{};                          // of the loop, delay not in it
  double last_angle_deg_ = 0.0;
  double scaled_deg_ = 0.0;
  bool started_ = false;
  History<Point> points_;
};

}  // namespace thermorig::labels

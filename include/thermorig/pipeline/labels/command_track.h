// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/history.h"
#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

/// What telemetry says of a span of time: that in it and the message on either side of it, which it lies
/// between.
struct CommandSpan {
  bool covered = false;     // telemetry reaches from its begin to its end without a gap
  bool able = true;         // armed, no fault
  bool disagrees = false;   // a message that TelemetryCheck objects to
  bool outside_leg = true;  // leg 0 somewhere, or no telemetry
  bool several_legs = false;
  float time_uncertainty_s = 0.0F;  // the widest of the telemetry that was used
};

/// The commanded motion as the firmware reports it: angle and speed run straight from one telemetry message
/// to the next, each at its stamped time.
class CommandTrack {
 public:
  /// More than `gap` between two messages is a gap, by the servo's own clock: a read that a busy host delays
  /// is none. Messages older than `length` are forgotten.
  CommandTrack(const PulseScale& scale, HostDuration gap, HostDuration length);

  /// `pulses`: those of the message (PulseTrain).
  void add(const TimedServo& servo, std::span<const Pulse> pulses);

  /// True if telemetry at or after `time` has come.
  bool reaches(HostTime time) const { return points_.reaches(time); }

  /// begin <= end, here and below.
  CommandSpan over(HostTime begin, HostTime end) const;

  /// True if the span is covered, and the servo was not told to move in it: it holds or is disarmed.
  bool rests(HostTime begin, HostTime end) const;

  /// The exact integral of the speed over the span, divided by its length. None if it is not covered.
  std::optional<double> mean_rate_dps(HostTime begin, HostTime end) const;

  /// How far from the middle of the travel the commanded angle comes in the span; NaN without telemetry.
  double farthest_deg(HostTime begin, HostTime end) const;

  /// The speed that the pulses command over a span, if it lies in a stretch of constant commanded speed: the
  /// least-squares slope of the pulses' angles (continuous servo: the mean of their rates) from as far back
  /// as the stretch goes, 5 s at most, to the span's end. The width of a pulse is a whole number of ticks;
  /// over a longer stretch that matters less. None if the speed varies, or there are fewer than 5 pulses.
  std::optional<double> constant_rate_dps(HostTime begin, HostTime end) const;

  /// Commanded angle at `time`, NaN where no telemetry covers it.
  double angle_deg(HostTime time) const;

  /// The leg that the last telemetry at or before `time` reported; 0 if there is none, or a gap behind it.
  std::uint16_t leg(HostTime time) const;

 private:
  struct Point {
    HostTime time{};
    std::int64_t mcu_time_us = 0;
    double rate_dps = 0.0;
    double angle_deg = 0.0;
    float uncertainty_s = 0.0F;
    std::uint16_t leg = 0;
    bool able = true;
    bool resting = true;
    bool disagrees = false;
  };
  struct Constant {  // up to a point
    HostTime until{};
    std::int64_t begin_us = 0;
    std::optional<double> rate_dps;
  };
  struct Commanded {  // by a pulse
    HostTime time{};
    std::int64_t start_us = 0;
    double value = 0.0;
  };
  struct Motion {
    double rate_dps = 0.0;
    double angle_deg = 0.0;
  };
  std::span<const Point> around(HostTime begin, HostTime end) const;
  bool is_gap(const Point& before, const Point& after) const;
  bool covers(std::span<const Point> points, HostTime begin, HostTime end) const;
  Motion at(HostTime time) const;

  std::int64_t constant_begin_us(const Point& last) const;
  std::optional<double> pulse_rate_dps(std::int64_t begin_us, std::int64_t end_us) const;

  PulseScale scale_;
  HostDuration gap_;
  TelemetryCheck check_;
  History<Point> points_;
  History<Commanded> pulses_;
  mutable std::optional<Constant> constant_;  // as asked for last: a frame and its newer half end together
};

}  // namespace thermorig::labels

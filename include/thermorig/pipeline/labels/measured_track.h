// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "thermorig/core/estimate.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/history.h"

namespace thermorig::labels {

/// The shaft over the last few seconds, by what measures it.
///
/// The angle at an instant is that of a straight line through the readings up to 50, 25, 12.5 or 5.5 ms
/// either way of it, whichever is the most certain: the noise of the readings counts, by how much they stray
/// from the line beyond it, and how far lines through fewer of them are from it: then the shaft does not move
/// evenly.
///
/// A servo that is asked for each reading answers some 40 times a second, and not while the host is busy.
/// There, two readings on either side say between which angles the shaft passes, whether it gains speed or
/// loses it; that counts where it is more certain than a line.
class MeasuredTrack {
 public:
  /// How far around an instant readings are of use.
  static constexpr double reach_s = 0.05;

  /// Readings older than `length` are forgotten. `bridged`: the longest silence that is bridged; 0: none is,
  /// and it is one from 30 ms on.
  explicit MeasuredTrack(HostDuration length, HostDuration bridged = HostDuration::zero())
      : points_(length), bridged_(bridged) {}

  void add(const TimedShaft& shaft);

  /// Whether any angle has come.
  bool is_there() const { return !points_.all().empty(); }

  /// True if an angle at or after `time` has come.
  bool reaches(HostTime time) const { return points_.reaches(time); }

  /// None: it lies in a silence that is not bridged, or turns were counted anew in it.
  std::optional<Estimate> angle_deg(HostTime time) const;

  /// Mean speed, by the angles at both instants; the turns between them must have been counted through.
  std::optional<Estimate> rate_dps(HostTime begin, HostTime end) const;

  /// Of the clock of the readings at that time, one standard deviation.
  float time_uncertainty_s(HostTime time) const;

 private:
  struct Point {
    HostTime time{};
    double angle_deg = 0.0;
    float uncertainty_deg = 0.0F;
    float time_uncertainty_s = 0.0F;
    unsigned lap = 0;  // counts the times at which turns were counted anew
  };
  struct At {
    Estimate angle_deg;
    unsigned lap = 0;
    float time_uncertainty_s = 0.0F;
  };
  std::optional<At> at(HostTime time) const;
  std::optional<At> between_readings(HostTime time, std::size_t after) const;

  History<Point> points_;
  HostDuration bridged_;
  unsigned lap_ = 0;
};

}  // namespace thermorig::labels

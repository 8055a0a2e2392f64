// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::estimators {

inline double exposure_s(const TimedFrame& frame) {
  return to_s(frame.exposure_end - frame.exposure_begin);
}

/// Of a mean over samples whose times are not sure, and which stand for half a period about them.
inline double mean_shift_dps(double change_dps, double length_s, const GyroProfile& gyro) {
  const double time_s = std::hypot(gyro.link.latency_uncertainty_s, 0.5 / gyro.output_rate_hz);
  return length_s > 0.0 ? change_dps * std::min(1.0, time_s / length_s) : 0.0;
}

/// No order of messages and no fit of a clock sets times back so far: its device's clock was reset.
constexpr HostDuration clock_begins_anew = std::chrono::seconds(1);

/// The least and the greatest rate of some samples.
struct RateExtent {
  double low_dps = std::numeric_limits<double>::infinity(), high_dps = -low_dps;
  void add(double rate_dps) {
    low_dps = std::min(low_dps, rate_dps);
    high_dps = std::max(high_dps, rate_dps);
  }
};

/// What a gyro has turned by since its first sample: trapezoids between neighbouring samples, also where some
/// were lost between them.
class GyroAngle {
 public:
  explicit GyroAngle(double period_s) : period_s_(period_s) {}

  /// Those of a frame.
  void add(std::span<const TimedGyro> samples) {
    before_ = std::exchange(newest_, {});
    for (const TimedGyro& sample : samples) add(sample);
  }

  /// How much the rate changed over the last two frames: no frame shows more of it.
  double change_dps() const {
    const double change_dps =
        std::max(newest_.high_dps, before_.high_dps) - std::min(newest_.low_dps, before_.low_dps);
    return std::max(0.0, change_dps);
  }

  bool has_begun() const { return last_.has_value(); }

  struct Turn {
    double angle_deg = 0.0;         // bias not removed
    double rate_dps = 0.0;          // of the last sample
    double elapsed_s = 0.0;         // since the first sample
    double unseen_sigma_deg = 0.0;  // while samples were lost
  };
  /// Up to a time; after the last sample its rate goes on. Only once it has begun.
  Turn until(HostTime time) const {
    const double step_s = std::max(0.0, to_s(time - last_->time));
    return {turn_.angle_deg + last_->rate_dps * step_s, last_->rate_dps, turn_.elapsed_s + step_s,
            std::hypot(turn_.unseen_sigma_deg, unseen_deg(lost_s(step_s, period_s_)))};
  }

 private:
  struct Point {
    HostTime time{};
    double rate_dps = 0.0;
  };

  void add(const TimedGyro& sample) {
    if (!is_rate(sample.rate_dps)) return;
    const Point point{sample.stamp.time, double{sample.rate_dps}};
    newest_.add(point.rate_dps);
    if (last_ && point.time <= last_->time) {
      if (last_->time - point.time >= clock_begins_anew) last_ = point;
      return;
    }
    if (last_) {
      const double step_s = to_s(point.time - last_->time);
      turn_.angle_deg += 0.5 * (point.rate_dps + last_->rate_dps) * step_s;
      turn_.elapsed_s += step_s;
      turn_.unseen_sigma_deg = std::hypot(turn_.unseen_sigma_deg, unseen_deg(lost_s(step_s, period_s_)));
    }
    last_ = point;
  }

  double period_s_;
  std::optional<Point> last_;
  RateExtent newest_, before_;  // of the last frame and the one before
  Turn turn_;                   // up to the last sample
};

}  // namespace thermorig::estimators

// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "gyro_integral.h"
#include "shaft_curve.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

/// What a gyro's low-pass makes of a rate: shares of what the rate was some time ago. A Butterworth filter of
/// second order is assumed, as in GyroProfile. Times of the gyro are those of what it shows: the group delay
/// is taken off them.
class LowPass {
 public:
  /// `delay_s`: its group delay. Less than 3 ms is none to speak of.
  explicit LowPass(double delay_s) {
    if (!(delay_s >= least_delay_s)) return;
    taps_.clear();
    // The step response, over x, the time over the delay.
    const auto passed = [](double x) { return 1.0 - std::exp(-x) * (std::cos(x) + std::sin(x)); };
    for (double x = last; x > 0.0; x -= step)  // in the order of the times that they look at
      taps_.push_back({(x - step / 2.0 - 1.0) * delay_s, (passed(x) - passed(x - step)) / passed(last)});
  }

  /// The mean that is shown from `begin_s` to `end_s`. `mean(begin, end)`: the rate's own.
  template <typename Mean>
  double shown_dps(double begin_s, double end_s, Mean mean) const {
    double rate_dps = 0.0;
    for (const Tap& tap : taps_) rate_dps += tap.share * mean(begin_s - tap.late_s, end_s - tap.late_s);
    return rate_dps;
  }

 private:
  static constexpr double least_delay_s = 0.003;
  static constexpr double step = 0.25, last = 6.0;  // of the delay
  struct Tap {
    double late_s;  // by the gyro's times
    double share;
  };
  std::vector<Tap> taps_{{0.0, 1.0}};
};

/// How the shaft follows a change of speed.
struct LoopFit {
  Estimate delay_s;
  double loop_hz = 0.0;
  double dead_band_deg = 0.0;
  double residual_dps = 0.0;  // root mean square of what is left around the changes, means over 20 ms
};

/// Delay, bandwidth and dead band that make the model's mean rate over 20 ms (one pulse period: the ripple of
/// the pulses plays no part), seen through the gyro's low-pass of the group delay `filter_delay_s` (which the
/// gyro's times have in them), most like the gyro's, around the changes of speed; up
/// to a factor and a constant, which are found elsewhere. None if there are fewer than three changes that the
/// gyro saw, or the gyro does not follow them. `has_loop`: false where what is
/// commanded is where the shaft is, so that the delay is that of the clocks alone.
std::optional<LoopFit> fit_loop(std::span<const PulseAt> pulses, std::span<const Interval> changes,
                                const GyroIntegral& gyro, double filter_delay_s, const ServoProfile& profile,
                                bool has_loop);

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

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

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace thermorig::odometer {

/// How noisy the gyro's samples are, by how means of a fortieth of a second leave a straight line: gears
/// that shake a turning rig make it twenty times noisier than it is at rest. What a shaft does in so short a
/// time counts as noise too.
class GyroNoise {
 public:
  explicit GyroNoise(double period_s)
      : block_(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(block_s / period_s)))) {}

  /// `follows`: no sample is missing before it.
  void add(double rate_dps, double step_s, bool follows) {
    if (!follows) samples_ = blocks_ = 0, sum_dps_ = sum_s_ = 0.0;
    sum_dps_ += rate_dps;
    sum_s_ += step_s;
    if (++samples_ < block_) return;
    means_dps_ = {means_dps_[1], means_dps_[2], sum_dps_ / static_cast<double>(block_)};
    if (++blocks_ >= means_dps_.size()) learn(sum_s_);
    samples_ = 0;
    sum_dps_ = sum_s_ = 0.0;
  }

  /// By how much it makes an angle walk away: variance in a second, deg^2.
  double walk_deg2() const { return walk_deg2_; }

 private:
  static constexpr double block_s = 0.025;
  static constexpr double median_of_square = 0.455;  // of a normal one, of its variance
  // Of a median that follows: a leg at which the shaft sticks and slips hardly moves it.
  static constexpr double first_step = 0.3, slowest_step = 0.003;
  static constexpr double least_deg2 = 1e-6, most_deg2 = 0.06;  // 3.5 deg/s in each of 200 samples a second

  /// A median: ramps are no noise.
  void learn(double length_s) {
    const double bend_dps = means_dps_[0] - 2.0 * means_dps_[1] + means_dps_[2];
    const double seen_deg2 = bend_dps * bend_dps / 6.0 * length_s / median_of_square;
    const double step = std::max(slowest_step, first_step * 10.0 / (10.0 + static_cast<double>(learnt_++)));
    walk_deg2_ =
        std::clamp(walk_deg2_ * (seen_deg2 > walk_deg2_ ? 1.0 + step : 1.0 - step), least_deg2, most_deg2);
  }

  std::size_t block_, samples_ = 0, blocks_ = 0, learnt_ = 0;
  double sum_dps_ = 0.0, sum_s_ = 0.0;
  std::array<double, 3> means_dps_{};
  double walk_deg2_ = 1e-4;
};

}  // namespace thermorig::odometer

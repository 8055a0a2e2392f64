// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "thermorig/core/sample.h"
#include "thermorig/core/surroundings/half_frame.h"

namespace thermorig::odometer {

/// How far a gyro's noise lets its angle walk, heard on the two axes across the shaft: along it a servo's
/// jerks would count as noise. By means over a tenth of a second: what is faster averages out.
class GyroNoise {
 public:
  /// `axis`: of the gyro, along the shaft.
  explicit GyroNoise(int axis)
      : across_{static_cast<std::size_t>(axis + 1) % 3, static_cast<std::size_t>(axis + 2) % 3} {}

  /// `step_s`: since the sample before.
  void add(const TimedGyro& sample, double step_s) {
    newest_.length_s += step_s;
    newest_.shaft_deg += step_s * double{sample.rate_dps};
    for (std::size_t i = 0; i < across_.size(); ++i)
      newest_.across_deg[i] += step_s * double{sample.reading.rate_dps[across_[i]]};
    if (newest_.length_s < block_s) return;
    if (last_.is_whole() && newest_.is_whole()) learn();
    last_ = newest_;
    newest_ = {};
  }

  /// Variance of what the angle walks by in a second.
  double walk_deg2() const { return walk_deg2_; }

 private:
  static constexpr double block_s = 0.1, learning_share = 0.05;
  static constexpr double even_dps = 5.0;     // a shaft whose speed changes by more shows on the other axes
  static constexpr double most_dps2 = 100.0;  // of one change: beyond, a reading is broken
  struct Block {
    double length_s = 0.0, shaft_deg = 0.0;
    std::array<double, 2> across_deg{};
    bool is_whole() const { return length_s > 0.0 && length_s < 2.0 * block_s; }
    double mean_dps(double deg) const { return deg / length_s; }
  };

  void learn() {
    const auto change_dps = [&](double later_deg, double before_deg) {
      return newest_.mean_dps(later_deg) - last_.mean_dps(before_deg);
    };
    if (std::abs(change_dps(newest_.shaft_deg, last_.shaft_deg)) > even_dps) return;
    double squares = 0.0;
    for (std::size_t i = 0; i < across_.size(); ++i)
      squares += square(change_dps(newest_.across_deg[i], last_.across_deg[i]));
    const double whole = squares < most_dps2 ? squares : most_dps2;  // NaN too
    // Two axes, and the noise of two blocks in each change.
    walk_deg2_ += learning_share * (0.25 * whole * newest_.length_s - walk_deg2_);
  }

  std::array<std::size_t, 2> across_;
  Block newest_, last_;
  double walk_deg2_ = 0.0;
};

}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "tracker.h"

namespace thermorig::odometer {

/// Whether innovations all lean to one side, over the last two seconds: then what was learnt of the sensors
/// is wrong.
class InnovationLean {
 public:
  /// Of a rig that turns so fast by now.
  void begin(double rate_dps) {
    mean_ = 0.0;
    mean_rate_dps_ = rate_dps;
  }
  void add(const HalfResult& result) {
    mean_rate_dps_ += share * (result.rate_dps - mean_rate_dps_);
    mean_ += share * (std::copysign(std::sqrt(result.squared), result.innovation_deg) - mean_);
  }
  /// Something was done about it.
  void forget() { mean_ = 0.0; }

  bool is_much(bool things_move) const { return std::abs(mean_) >= (things_move ? most_in_traffic : most); }
  /// The rig turned at another speed than now within the same time: what depends on the speed shows then.
  bool came_with_other_speed(double rate_dps) const {
    return std::abs(rate_dps - mean_rate_dps_) > other_speed_dps;
  }

 private:
  static constexpr double share = 1.0 / 16.0;
  static constexpr double most = 0.7, most_in_traffic = 1.0;  // innovations, in units of what was expected
  static constexpr double other_speed_dps = 10.0;

  double mean_ = 0.0;  // with their signs
  double mean_rate_dps_ = 0.0;
};

}  // namespace thermorig::odometer

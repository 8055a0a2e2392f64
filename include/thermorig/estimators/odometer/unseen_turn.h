// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

namespace thermorig::odometer {

/// What a shaft may have turned by beside a straight line through both ends of a time in which nothing
/// measured it, one standard deviation: it may have left its speed and come back to it.
inline double unseen_deg(double gap_s) {
  constexpr double acceleration_dps2 = 2000.0;
  constexpr double speed_dps = 200.0;
  return std::min(acceleration_dps2 * gap_s * gap_s / 16.0, speed_dps * gap_s);
}

/// How much of the time between two samples was lost: a sample is the mean over its period.
inline double lost_s(double step_s, double period_s) {
  return step_s > 1.5 * period_s ? step_s - period_s : 0.0;
}

}  // namespace thermorig::odometer

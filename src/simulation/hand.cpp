// SPDX-License-Identifier: MIT
#include "hand.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace thermorig::simulation {

Hand::Hand(const std::vector<HandTurn>& turns, HostTime start) {
  for (const HandTurn& turn : turns) {
    assert(turn.duration_s > 0.0);
    turns_.push_back({to_s(turn.begin - start), turn.duration_s, turn.angle_deg});
  }
}

double Hand::Turn::part(std::int64_t time_ns) const {
  return std::clamp((static_cast<double>(time_ns) * 1e-9 - begin_s) / duration_s, 0.0, 1.0);
}

double Hand::angle_deg(std::int64_t time_ns) const {
  double sum_deg = 0.0;
  for (const Turn& turn : turns_) {
    const double circle_rad = 2.0 * std::numbers::pi * turn.part(time_ns);
    sum_deg += turn.angle_deg * (circle_rad - std::sin(circle_rad)) / (2.0 * std::numbers::pi);
  }
  return sum_deg;
}

double Hand::rate_dps(std::int64_t time_ns) const {
  double sum_dps = 0.0;
  for (const Turn& turn : turns_)
    sum_dps +=
        turn.angle_deg / turn.duration_s * (1.0 - std::cos(2.0 * std::numbers::pi * turn.part(time_ns)));
  return sum_dps;
}

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include "shaft.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::simulation {

double mean_rate_dps(const ShaftMark& from, const ShaftMark& to) {
  return (to.angle_deg - from.angle_deg) / (static_cast<double>(to.time_ns - from.time_ns) * 1e-9);
}

void Shaft::append(double angle_deg) {
  angles_deg_.push_back(angle_deg);
  if (static_cast<std::int64_t>(angles_deg_.size()) < 8 * kept_steps) return;
  const auto surplus = static_cast<std::int64_t>(angles_deg_.size()) - kept_steps;
  angles_deg_.erase(angles_deg_.begin(), angles_deg_.begin() + surplus);
  first_index_ += surplus;
}

double Shaft::angle_deg(std::int64_t time_ns) const {
  if (time_ns <= 0 && first_index_ == 0) return angles_deg_.front();
  const std::int64_t step = time_ns / step_ns;
  assert(step >= first_index_ && time_ns <= known_until_ns());
  const auto left = static_cast<std::size_t>(step - first_index_);
  const std::size_t right = std::min(left + 1, angles_deg_.size() - 1);
  const double part = static_cast<double>(time_ns - step * step_ns) / static_cast<double>(step_ns);
  return std::lerp(angles_deg_[left], angles_deg_[right], part);
}

}  // namespace thermorig::simulation

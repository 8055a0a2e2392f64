// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/quota.h"

#include <algorithm>
#include <cmath>

namespace thermorig::rig {

namespace {

long hundredths(double rate_dps) {
  return std::lround(100.0 * rate_dps);
}

}  // namespace

bool SpeedQuota::is_short() const {
  return valid < wanted - quota_tolerance_frames;
}

ValidQuota::ValidQuota(const SweepPlan& plan) : step_rates_dps_(plan.leg_rates_dps) {
  for (const double rate_dps : step_rates_dps_) {
    SpeedQuota& speed = speeds_[hundredths(rate_dps)];
    speed.rate_dps = rate_dps;
    speed.wanted += plan.valid_per_leg;
    wanted_by_step_.push_back(speed.wanted);
  }
}

void ValidQuota::leg(std::uint16_t number, double rate_dps) {
  legs_[number] = std::abs(rate_dps);
}

void ValidQuota::sample(const LabelledSample& sample) {
  if (!sample.valid) return;
  const auto leg = legs_.find(sample.leg);
  if (leg == legs_.end()) return;
  const double rate_dps = std::copysign(leg->second, sample.rate_shaft_dps);
  const auto speed = speeds_.find(hundredths(rate_dps));
  if (speed != speeds_.end()) ++speed->second.valid;
}

int ValidQuota::missing(std::size_t step, int spare) const {
  const SpeedQuota& speed = speeds_.at(hundredths(step_rates_dps_[step]));
  return std::max(0, wanted_by_step_[step] + spare - speed.valid);
}

std::vector<SpeedQuota> ValidQuota::speeds() const {
  std::vector<SpeedQuota> ascending;
  for (const auto& [key, speed] : speeds_) ascending.push_back(speed);
  return ascending;
}

}  // namespace thermorig::rig

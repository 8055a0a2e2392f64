// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/step_queue.h"

#include <algorithm>
#include <utility>

namespace thermorig::rig {

namespace {

constexpr double label_patience_s = 3.0;  // a frame waits a second at most for its label

}  // namespace

void StepQueue::fill() {
  for (std::size_t i = 0; i < plan_.leg_rates_dps.size(); ++i) to_drive_.push_back({.index = i});
}

int StepQueue::number() const {
  return static_cast<int>(empty() ? plan_.leg_rates_dps.size() : front().index + 1);
}

std::optional<double> StepQueue::rate_dps_at(std::size_t place) const {
  if (to_drive_.size() <= place) return std::nullopt;
  return plan_.leg_rates_dps[to_drive_[place].index];
}

void StepQueue::drive_again(const Step& step) {
  to_drive_.insert(empty() ? to_drive_.end() : to_drive_.begin() + 1, step);
}

bool StepQueue::is_driven_again(std::size_t step) const {
  return std::any_of(to_drive_.begin(), to_drive_.end(),
                     [step](const Step& other) { return other.index == step; });
}

void StepQueue::finish_front(std::uint64_t labels, HostTime now) {
  if (plan_.valid_per_leg > 0) unlabelled_.push_back({front().index, labels, now});
  to_drive_.pop_front();
}

std::optional<std::size_t> StepQueue::take_labelled(std::uint64_t labels, HostTime now) {
  if (unlabelled_.empty()) return std::nullopt;
  const Unlabelled first = unlabelled_.front();
  if (labels < first.labels && to_s(now - first.left) <= label_patience_s) return std::nullopt;
  unlabelled_.pop_front();
  return first.step;
}

SweepPlan StepQueue::plan_left() const {
  SweepPlan plan = plan_;
  plan.leg_rates_dps.clear();
  for (const Step& step : to_drive_) plan.leg_rates_dps.push_back(plan_.leg_rates_dps[step.index]);
  return plan;
}

}  // namespace thermorig::rig

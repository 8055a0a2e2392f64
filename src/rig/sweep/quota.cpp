// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/quota.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

namespace {

// Of frames that have no label yet, so many may turn out invalid; and of a leg that goes back and forth, by
// the session's labels, which see the bends of each sweep with better clocks.
constexpr int margin_frames = 1;
constexpr double patience = 1.5;  // a step may take so many times the frames that it should
constexpr int least_growth = 5;   // and in any case so many times those of the plan
constexpr int fruitless_frames_min = 24;
constexpr int frames_in_flight = 8;  // that have no label yet

std::size_t step_of(const DrivenLeg& leg) {
  return static_cast<std::size_t>(leg.record().step);
}

}  // namespace

StepQuota::StepQuota(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz)
    : plan_(plan), servo_(servo), valid_(plan) {
  for (const ExpectedLeg& leg : expected_legs(plan, servo, nominal_frame_rate_hz))
    steps_.push_back({.expected = leg});
}

void StepQuota::begin(const LegRecord& leg) {
  valid_.leg(leg.leg, leg.rate_dps);
  fruitless_ = 0;
}

void StepQuota::ended(const LegRecord& leg) {
  steps_[static_cast<std::size_t>(leg.step)].frames += leg.frames;
}

void StepQuota::sample(const LabelledSample& sample) {
  ++samples_;
  valid_.sample(sample);
  if (sample.valid)
    fruitless_ = 0;
  else if (sample.leg != 0)
    ++fruitless_;
}

std::uint64_t StepQuota::samples_with(const DrivenLeg& leg) const {
  return frames_ + static_cast<std::uint64_t>(std::max(0, leg.missing()));
}

int StepQuota::missing(const DrivenLeg& leg) const {
  return valid_.missing(step_of(leg), plan_.valid_per_leg > 0 && leg.turn_back() ? margin_frames : 0);
}

double StepQuota::frames_needed(std::size_t step, double frame_rate_hz) const {
  return frames_for(missing(step), steps_[step].expected.course, frame_rate_hz);
}

double StepQuota::leg_frames(std::size_t step, double frame_rate_hz) const {
  return std::max(1.0 * plan_.frames_per_leg, frames_needed(step, frame_rate_hz));
}

int StepQuota::frames_wanted(const DrivenLeg& leg, double frame_rate_hz) const {
  return missing(leg) + margin_frames - frames_awaited(leg, frame_rate_hz);
}

/// Frames of this leg that have no label yet, but will be valid. Nobody knows of a servo that turns back.
int StepQuota::frames_awaited(const DrivenLeg& leg, double frame_rate_hz) const {
  if (leg.turn_back()) return 0;
  const double lost_s = steps_[step_of(leg)].expected.course.ramp_s + window_s(1, servo_, frame_rate_hz);
  const int lost = static_cast<int>(std::ceil(lost_s * frame_rate_hz));
  const int unlabelled = static_cast<int>(frames_ - samples_);
  return std::max(0, std::min(unlabelled, leg.record().frames - lost)) + leg.missing();
}

/// Frames that a step may have in all its legs.
double StepQuota::frames_limit(const StepState& step) const {
  const double planned = plan_.frames_per_leg;
  return std::clamp(patience * step.expected.frames, least_growth * planned, frames_growth_max * planned);
}

std::optional<std::string> StepQuota::give_up(std::size_t step, int frames) {
  StepState& state = steps_[step];
  if (state.is_given_up) return std::nullopt;
  const int driven = state.frames + frames;
  const double limit = frames_limit(state);
  const int missing = valid_.missing(step);
  const double valid = std::max(0, plan_.valid_per_leg - missing);
  const bool is_hopeless = driven * static_cast<double>(missing) > valid * (limit - driven);
  const bool is_fruitless = fruitless_ >= std::max(plan_.frames_per_leg, fruitless_frames_min);
  const bool is_long_enough = driven >= state.expected.frames + frames_in_flight;
  if (driven < limit && !is_fruitless && !(is_hopeless && is_long_enough)) return std::nullopt;
  state.is_given_up = true;
  return fmt::format(
      "step {} of {} ({:+g} deg/s): still {} valid frames short after {} frames; going on "
      "without them",
      step + 1, steps_.size(), state.expected.rate_dps, missing, driven);
}

}  // namespace thermorig::rig

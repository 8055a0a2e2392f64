// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/step_quota.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace thermorig::rig {

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

// SPDX-License-Identifier: MIT
// Sums of the sweep: how long, how far, from where, and what is left.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "thermorig/rig/sweep.h"

namespace thermorig::rig {

namespace {

constexpr double angle_tolerance_deg = 0.05;

/// The plan with nothing but these steps to drive.
template <typename Steps>
SweepPlan only(SweepPlan plan, const Steps& steps) {
  std::vector<double> rates_dps;
  for (const auto& step : steps) rates_dps.push_back(plan.leg_rates_dps[step.index]);
  plan.leg_rates_dps = std::move(rates_dps);
  return plan;
}

}  // namespace

double SweepWalker::rate_dps() const {
  return to_drive_.empty() ? 0.0 : plan_.leg_rates_dps[to_drive_.front().index];
}

int SweepWalker::step_number() const {
  return static_cast<int>(to_drive_.empty() ? plan_.leg_rates_dps.size() : to_drive_.front().index + 1);
}

double SweepWalker::leg_duration_s(double frames) const {
  return (frames + 0.5) / frames_.rate_hz() + 0.1;
}

double SweepWalker::travel_deg() const {
  const double frames = std::max(1.0 * plan_.frames_per_leg, frames_to_quota());
  return leg_travel_deg(rate_dps(), frames, frames_.rate_hz(), servo_.acceleration_dps2);
}

double SweepWalker::start_angle_deg() const {
  const double limit_deg = angle_limit_deg(servo_).value_or(0.0);
  return -sign_of(rate_dps()) * std::min(travel_deg() / 2.0, limit_deg);
}

bool SweepWalker::fits_from_here() const {
  const auto limit_deg = angle_limit_deg(servo_);
  if (!limit_deg || !last_telemetry_) return true;
  const double way_deg = std::min(travel_deg(), 2.0 * *limit_deg);
  return sign_of(rate_dps()) * last_telemetry_->state.angle_deg + way_deg <= *limit_deg + angle_tolerance_deg;
}

// Where the shaft is, as far as anybody knows: so that the first pulse moves nothing.
double SweepWalker::arm_angle_deg() const {
  const double limit_deg = angle_limit_deg(servo_).value_or(0.0);
  const double reported_deg = last_telemetry_ ? last_telemetry_->state.angle_deg : 0.0;
  return std::clamp(driven_angle_deg_.value_or(reported_deg), -limit_deg, limit_deg);
}

bool SweepWalker::servo_at_rest() const {
  return last_telemetry_ && is_at_rest(last_telemetry_->state);
}

bool SweepWalker::servo_is_disarmed() const {
  return last_telemetry_ && last_telemetry_->state.motion == ServoMotion::disarmed;
}

std::optional<double> SweepWalker::next_rate_dps() const {
  const std::size_t next = phase_ == SweepPhase::leg ? 1 : 0;
  if (to_drive_.size() <= next) return std::nullopt;
  return plan_.leg_rates_dps[to_drive_[next].index];
}

SweepProgress SweepWalker::progress(HostTime now) const {
  SweepProgress progress;
  progress.phase = phase_;
  progress.leg_count = static_cast<int>(plan_.leg_rates_dps.size());
  progress.leg = step_number();
  if (phase_ == SweepPhase::waiting || phase_ == SweepPhase::greeting || phase_ == SweepPhase::opening_rest)
    progress.leg = 0;
  progress.rate_dps = phase_ == SweepPhase::leg ? rate_dps() : 0.0;
  progress.next_rate_dps = next_rate_dps();
  progress.frames = phase_ == SweepPhase::leg ? leg_.record().frames : 0;
  progress.frames_per_leg = plan_.frames_per_leg;
  progress.repeated = repeated_;
  progress.speeds = quota_.speeds();
  for (const SpeedQuota& speed : progress.speeds) {
    if (phase_ != SweepPhase::leg || speed.rate_dps != rate_dps()) continue;
    progress.valid = speed.valid;
    progress.valid_quota = speed.wanted;
  }
  progress.eta_s = remaining_s(now);
  const double whole_s = plan_duration_s(plan_, servo_, frames_.rate_hz());
  double undriven_s = progress.eta_s;
  const bool is_over = phase_ == SweepPhase::done || phase_ == SweepPhase::stopping;
  if (is_over && !to_drive_.empty()) {  // it was stopped: what it leaves undriven is not done
    SweepPlan rest = only(plan_, to_drive_);
    rest.opening_rest_s = 0.0;
    undriven_s = plan_duration_s(rest, servo_, frames_.rate_hz());
  }
  progress.done_share = whole_s > 0.0 ? std::clamp(1.0 - undriven_s / whole_s, 0.0, 1.0) : 1.0;
  return progress;
}

// What is still to be driven, without what has passed of the current phase.
double SweepWalker::remaining_s(HostTime now) const {
  if (phase_ == SweepPhase::done || phase_ == SweepPhase::stopping) return 0.0;
  SweepPlan rest = only(plan_, to_drive_);
  double passed_s = 0.0;
  const double phase_s = to_s(now - phase_begin_);
  if (phase_ == SweepPhase::opening_rest) passed_s = std::min(phase_s, plan_.opening_rest_s);
  if (phase_ == SweepPhase::closing_rest) passed_s = std::min(phase_s, plan_.closing_rest_s);
  if (phase_ == SweepPhase::leg) passed_s = leg_duration_s(leg_.record().frames);
  if (phase_ > SweepPhase::opening_rest) rest.opening_rest_s = 0.0;
  if (phase_ == SweepPhase::halting) rest.closing_rest_s = 0.0;
  return std::max(0.0, plan_duration_s(rest, servo_, frames_.rate_hz()) - passed_s);
}

}  // namespace thermorig::rig

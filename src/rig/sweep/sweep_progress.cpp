// SPDX-License-Identifier: MIT
// Where a sweep stands: what it has driven, and what is left.
#include <algorithm>

#include "thermorig/rig/sweep/sweep_walker.h"

namespace thermorig::rig {

std::string name_of(SweepPhase phase) {
  constexpr const char* names[] = {
      "waiting",      "greeting", "opening rest", "transit", "leg",    "recovering", "waiting for a device",
      "closing rest", "halting",  "stopping",     "done",    "by hand"};
  return names[static_cast<std::size_t>(phase)];
}

double SweepWalker::remaining_s(HostTime now) const {
  if (has_ended()) return 0.0;
  if (!servo_.is_there())
    return std::max(0.0, plan_.opening_rest_s - by_hand_s_ -
                             (phase_ == SweepPhase::by_hand ? to_s(now - phase_begin_) : 0.0));
  SweepPlan left = steps_.plan_left();
  double passed_s = 0.0;
  const double phase_s = to_s(now - phase_begin_);
  if (phase_ == SweepPhase::opening_rest) passed_s = std::min(phase_s, plan_.opening_rest_s);
  if (phase_ == SweepPhase::closing_rest) passed_s = std::min(phase_s, plan_.closing_rest_s);
  if (phase_ == SweepPhase::leg) passed_s = leg_duration_s(leg_.record().frames, frames_.arrival_rate_hz());
  if (phase_ > SweepPhase::opening_rest) left.opening_rest_s = 0.0;
  if (phase_ == SweepPhase::halting) left.closing_rest_s = 0.0;
  return std::max(0.0, plan_duration_s(left, servo_, frames_.arrival_rate_hz()) - passed_s);
}

SweepProgress SweepWalker::progress(HostTime now) const {
  const bool is_leg = phase_ == SweepPhase::leg;
  const bool has_begun = phase_ > SweepPhase::opening_rest;
  SweepProgress progress{.phase = phase_,
                         .leg = has_begun ? steps_.number() : 0,
                         .leg_count = static_cast<int>(plan_.leg_rates_dps.size()),
                         .next_rate_dps = steps_.rate_dps_at(is_leg ? 1 : 0),
                         .frames_per_leg = plan_.frames_per_leg,
                         .eta_s = remaining_s(now),
                         .repeated = repeated_,
                         .speeds = quota_.speeds()};
  if (is_leg) {
    progress.rate_dps = steps_.rate_dps();
    progress.frames = leg_.record().frames;
    for (const SpeedQuota& speed : progress.speeds) {
      if (speed.rate_dps != progress.rate_dps) continue;
      progress.valid = speed.valid;
      progress.valid_quota = speed.wanted;
    }
  }
  const double whole_s = plan_duration_s(plan_, servo_, frames_.arrival_rate_hz());
  double undriven_s = progress.eta_s;
  if (has_ended() && !steps_.empty()) {  // it was stopped: what it leaves undriven is not done
    SweepPlan left = steps_.plan_left();
    left.opening_rest_s = 0.0;
    undriven_s = plan_duration_s(left, servo_, frames_.arrival_rate_hz());
  }
  progress.done_share = whole_s > 0.0 ? std::clamp(1.0 - undriven_s / whole_s, 0.0, 1.0) : 1.0;
  return progress;
}

}  // namespace thermorig::rig

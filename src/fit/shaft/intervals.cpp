// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/intervals.h"

#include <cmath>
#include <cstdlib>

namespace thermorig::fit {

namespace {
constexpr std::int64_t steady_gap_us = 250'000;                  // a GRBL board reports ten times a second
constexpr HostDuration longest_stall = std::chrono::seconds(1);  // by the host's clock, which may have jumped
constexpr double one_ramp_s = 0.1;                               // changes closer than this belong together

bool is_motion(const ServoState& state) {
  return state.fault == ServoFault::none && state.motion == ServoMotion::steady && state.rate_dps != 0.0;
}

bool follows(const TimedServo& before, const TimedServo& after) {
  return std::abs(after.mcu_time_us - before.mcu_time_us) <= steady_gap_us &&
         after.stamp.time - before.stamp.time <= longest_stall &&
         std::abs(after.state.rate_dps - before.state.rate_dps) <= constant_dps;
}
}  // namespace

std::vector<Interval> steady_intervals(std::span<const TimedServo> servo, HostTime origin, bool rests) {
  std::vector<Interval> intervals;
  const TimedServo* before = nullptr;  // in the interval that goes on
  for (const TimedServo& message : servo) {
    if (!(rests ? is_at_rest(message.state) : is_motion(message.state))) {
      before = nullptr;
      continue;
    }
    const double time_s = to_s(message.stamp.time - origin);
    if (before == nullptr || !follows(*before, message))
      intervals.push_back({time_s, time_s, message.state.rate_dps});
    intervals.back().end_s = time_s;
    intervals.back().leg = message.state.leg;
    before = &message;
  }
  return intervals;
}

std::vector<Interval> speed_changes(std::span<const TimedServo> servo, HostTime origin,
                                    double longest_gap_s) {
  std::vector<Interval> changes;
  for (std::size_t i = 1; i < servo.size(); ++i) {
    const TimedServo& before = servo[i - 1];
    const TimedServo& after = servo[i];
    const bool changed = std::abs(after.state.rate_dps - before.state.rate_dps) > constant_dps;
    const double gap_s = 1e-6 * static_cast<double>(std::abs(after.mcu_time_us - before.mcu_time_us));
    if (!changed || gap_s > longest_gap_s) continue;
    const double begin_s = to_s(before.stamp.time - origin), end_s = to_s(after.stamp.time - origin);
    if (changes.empty() || begin_s > changes.back().end_s + one_ramp_s)
      changes.push_back({begin_s, end_s, before.state.rate_dps});
    changes.back().end_s = end_s;
  }
  return changes;
}

}  // namespace thermorig::fit

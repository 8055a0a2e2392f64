// SPDX-License-Identifier: MIT
#include "shaft_curve.h"

#include <algorithm>

#include "gyro_integral.h"
#include "thermorig/pipeline/labels/shaft_track.h"

namespace thermorig::fit {

std::vector<PulseAt> all_pulses(std::span<const TimedServo> servo, const PulseScale& scale, HostTime origin,
                                double longest_gap_s) {
  labels::PulseTrain train(scale, from_s(longest_gap_s));
  std::vector<labels::Pulse> found;
  std::vector<PulseAt> pulses;
  for (const TimedServo& message : servo) {
    train.add(message, found);
    for (const labels::Pulse& pulse : found) {
      const double end_s = to_s(pulse.end - origin);
      pulses.push_back({pulses.empty() ? end_s : std::max(end_s, pulses.back().end_s), pulse.value,
                        pulse.rate_dps, pulse.restart});
    }
    found.clear();
  }
  return pulses;
}

ShaftCurve::ShaftCurve(std::span<const PulseAt> pulses, bool continuous, double loop_hz, double dead_band_deg,
                       double until_s) {
  labels::ServoLoop loop(continuous, loop_hz, dead_band_deg);
  loop.restart(pulses.front().value, pulses.front().rate_dps);
  double time_s = pulses.front().end_s;
  points_.push_back({time_s, loop.angle_deg(), loop.rate_dps()});
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    if (pulses[i].restart) loop.restart(pulses[i].value, pulses[i].rate_dps);
    const double end_s = i + 1 < pulses.size() ? pulses[i + 1].end_s : until_s;
    loop.advance(pulses[i].value, end_s - pulses[i].end_s, [&](double step_s) {
      time_s += step_s;
      points_.push_back({time_s, loop.angle_deg(), loop.rate_dps()});
    });
  }
}

double ShaftCurve::angle_deg(double time_s, std::size_t& near) const {
  const std::size_t after = first_after(points_, time_s, near);
  if (after == 0) return points_.front().angle_deg;
  if (after == points_.size()) return points_.back().angle_deg;
  const Point& a = points_[after - 1];
  const Point& b = points_[after];
  const double length_s = b.time_s - a.time_s;
  return labels::hermite(a.angle_deg, a.rate_dps, b.angle_deg, b.rate_dps, length_s,
                         (time_s - a.time_s) / length_s);
}

}  // namespace thermorig::fit

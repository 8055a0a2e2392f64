// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include "gyro_integral.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/intervals.h"
#include "thermorig/fit/shaft/servo_response.h"

namespace thermorig::fit {

namespace {
constexpr double decay_settled_s = 0.5;
constexpr double shortest_part_s = 1.0;         // of a leg's part that is looked at
constexpr double slowest_looked_at_dps = 10.0;  // below it a servo's own unsteadiness matters more
constexpr double least_decay = 0.03;            // a second: a servo keeps a slow speed better than that
constexpr double sure_deviations = 4.0;
constexpr std::size_t fewest_a_direction = 2;

struct LegDecay {
  double rate_dps, decay_per_s;
};

/// From the first to the second half of what is steady in each leg, as a share of the command.
std::vector<LegDecay> decays_of(std::span<const TimedServo> servo, const GyroIntegral& gyro,
                                HostTime origin) {
  std::vector<LegDecay> legs;
  for (const Interval& leg : steady_intervals(servo, origin, false)) {
    const double begin_s = leg.begin_s + decay_settled_s, half_s = (leg.end_s - begin_s) / 2.0;
    if (2.0 * half_s < shortest_part_s || std::abs(leg.rate_dps) < slowest_looked_at_dps) continue;
    const double fall_dps =
        gyro.mean_dps(begin_s, begin_s + half_s) - gyro.mean_dps(begin_s + half_s, leg.end_s);
    if (std::isfinite(fall_dps)) legs.push_back({leg.rate_dps, fall_dps / leg.rate_dps / half_s});
  }
  return legs;
}
}  // namespace

double gyro_decay_per_s(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                        const GyroErrors& errors) {
  if (gyro.empty() || servo.empty()) return 0.0;
  const HostTime origin = servo.front().stamp.time;
  const std::vector<LegDecay> legs = decays_of(servo, GyroIntegral(gyro, errors, origin), origin);
  std::vector<double> speeds_dps;
  for (const LegDecay& leg : legs) speeds_dps.push_back(std::abs(leg.rate_dps));
  const double usual_dps = median(std::move(speeds_dps));
  RunningStatistics forward, backward;
  for (const LegDecay& leg : legs)
    if (std::abs(leg.rate_dps) <= usual_dps) (leg.rate_dps > 0.0 ? forward : backward).add(leg.decay_per_s);
  const auto error = [](const RunningStatistics& of) {
    return std::sqrt(of.sample_variance() / static_cast<double>(of.count()));
  };
  if (std::min(forward.count(), backward.count()) < fewest_a_direction) return 0.0;
  const double decay = (forward.mean() + backward.mean()) / 2.0;
  const double sigma = std::hypot(error(forward), error(backward)) / 2.0;
  return decay > std::max(least_decay, sure_deviations * sigma) ? decay : 0.0;
}

}  // namespace thermorig::fit

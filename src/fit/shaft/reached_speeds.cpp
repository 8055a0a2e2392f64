// SPDX-License-Identifier: MIT
#include "reached_speeds.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "thermorig/core/estimate.h"
#include "thermorig/core/statistics.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

namespace {

constexpr double slope_error = 0.006;            // relative: a servo's along the part of its travel
constexpr double continuous_slope_error = 0.04;  // its speed against the pulse is no straight line
constexpr double floor_dps = 0.3;
constexpr double slowest_share_dps = 15.0;  // below it a bias matters more than the servo
constexpr double slow_gyro_s = 0.1;         // between samples
constexpr double caught_up_s = 1.0;         // beside the time for the angle that it lags behind

struct Sum {
  double angle_deg = 0.0, length_s = 0.0;
};

/// How far a speed is from its share of the command. With the same speed the other way the bias drops out of
/// it, however it moved; alone it is as uncertain as the bias.
Estimate distance(const ReachedSpeed& speed, const std::vector<ReachedSpeed>& speeds, double share,
                  double bias_uncertainty_dps) {
  const double off_dps = speed.reached_dps - share * speed.rate_dps;
  const auto opposite = std::find_if(speeds.begin(), speeds.end(), [&](const ReachedSpeed& other) {
    return std::abs(other.rate_dps + speed.rate_dps) < constant_dps;
  });
  if (opposite == speeds.end()) return {off_dps, bias_uncertainty_dps};
  return {(off_dps - (opposite->reached_dps - share * opposite->rate_dps)) / 2.0, 0.0};
}

/// How far a speed may be from its share, its bias apart. `slope`: of that kind of servo.
double explained_dps(double rate_dps, double slope) {
  return std::hypot(slope * rate_dps, floor_dps);
}

/// How many there are, the two directions of one taken as one. They ascend by size.
double count_sizes(const std::vector<ReachedSpeed>& speeds) {
  double sizes = 1.0;
  for (std::size_t i = 1; i < speeds.size(); ++i)
    sizes += std::abs(speeds[i].rate_dps) - std::abs(speeds[i - 1].rate_dps) > constant_dps ? 1.0 : 0.0;
  return sizes;
}

double slope_error_of(ServoKind kind) {
  return kind == ServoKind::continuous ? continuous_slope_error : slope_error;
}

/// What a bias makes of a share, where no speed is driven both ways.
double bias_share(const std::vector<ReachedSpeed>& speeds, double bias_uncertainty_dps) {
  double share = 0.0;
  for (const ReachedSpeed& speed : speeds) {
    const double bias_dps = distance(speed, speeds, 1.0, bias_uncertainty_dps).uncertainty;
    if (bias_dps == 0.0) return 0.0;
    share = std::max(share, bias_dps / std::max(std::abs(speed.rate_dps), slowest_share_dps));
  }
  return share;
}

/// Bias apart. Of few and slow speeds it is not known well.
std::optional<Estimate> usual_share(const std::vector<ReachedSpeed>& speeds, double slope) {
  std::vector<ReachedSpeed> useful;
  for (const ReachedSpeed& speed : speeds)
    if (std::abs(speed.rate_dps) >= slowest_share_dps) useful.push_back(speed);
  if (useful.empty()) return std::nullopt;
  std::stable_sort(useful.begin(), useful.end(), [](const ReachedSpeed& a, const ReachedSpeed& b) {
    return std::abs(a.rate_dps) < std::abs(b.rate_dps);
  });
  useful.resize((useful.size() + 1) / 2);
  std::vector<double> shares;
  RunningStatistics uncertainties;
  for (const ReachedSpeed& speed : useful) {
    shares.push_back(1.0 + distance(speed, speeds, 1.0, 0.0).value / speed.rate_dps);
    uncertainties.add(explained_dps(speed.rate_dps, slope) / std::abs(speed.rate_dps));
  }
  return Estimate{median(std::move(shares)),
                  median_scatter * uncertainties.mean() / std::sqrt(count_sizes(useful))};
}

}  // namespace

std::optional<Estimate> reached_share(const std::vector<ReachedSpeed>& speeds, double bias_uncertainty_dps,
                                      ServoKind kind) {
  std::optional<Estimate> share = usual_share(speeds, slope_error_of(kind));
  if (share) share->uncertainty = std::hypot(share->uncertainty, bias_share(speeds, bias_uncertainty_dps));
  return share;
}

std::vector<ReachedSpeed> reached_speeds(std::span<const Interval> legs, const GyroIntegral& gyro,
                                         double bias_uncertainty_dps, ServoKind kind) {
  std::map<long long, Sum> sums;  // by centidegrees per second
  // A sample stands for half a period on either side: of a slow gyro, for a part of the ramps.
  const double beside_s = gyro.period_s() > slow_gyro_s ? gyro.period_s() / 2.0 : 0.0;
  for (const Interval& leg : legs) {
    const double begin_s = leg.begin_s + settled_after_s + beside_s, end_s = leg.end_s - beside_s;
    if (leg.leg == 0 || !(begin_s < end_s)) continue;
    const double mean_dps = gyro.mean_dps(begin_s, end_s);
    if (!std::isfinite(mean_dps)) continue;
    Sum& sum = sums[std::llround(100.0 * leg.rate_dps)];
    sum.angle_deg += mean_dps * (end_s - begin_s);
    sum.length_s += end_s - begin_s;
  }
  std::vector<ReachedSpeed> speeds;
  for (const auto& [centi_dps, sum] : sums)
    speeds.push_back({0.01 * static_cast<double>(centi_dps), sum.angle_deg / sum.length_s, false});
  const double slope = slope_error_of(kind);
  const Estimate share = usual_share(speeds, slope).value_or(Estimate{1.0, 0.0});
  for (ReachedSpeed& speed : speeds) {
    const auto [off_dps, bias_dps] = distance(speed, speeds, share.value, bias_uncertainty_dps);
    const double deviation_dps =
        std::hypot(explained_dps(speed.rate_dps, slope), bias_dps, share.uncertainty * speed.rate_dps);
    speed.contradicts = std::abs(off_dps) > contradiction_deviations * deviation_dps;
  }
  return speeds;
}

std::vector<Interval> strayed_intervals(std::span<const Interval> legs,
                                        std::span<const ReachedSpeed> speeds) {
  std::vector<Interval> strayed;
  for (const Interval& leg : legs) {
    const auto of_leg = std::find_if(speeds.begin(), speeds.end(), [&](const ReachedSpeed& speed) {
      return std::abs(speed.rate_dps - leg.rate_dps) < constant_dps;
    });
    if (leg.leg == 0 || of_leg == speeds.end() || !of_leg->contradicts) continue;
    const double lag_deg = std::abs(of_leg->rate_dps - of_leg->reached_dps) * (leg.end_s - leg.begin_s);
    const double slowest_dps = std::max(std::abs(of_leg->reached_dps), slowest_share_dps);
    strayed.push_back(
        {leg.begin_s - caught_up_s, leg.end_s + caught_up_s + lag_deg / slowest_dps, leg.rate_dps, leg.leg});
  }
  return strayed;
}

bool is_within(std::span<const Interval> intervals, double time_s) {
  const auto next = std::upper_bound(intervals.begin(), intervals.end(), time_s,
                                     [](double time, const Interval& one) { return time < one.begin_s; });
  return next != intervals.begin() && time_s < (next - 1)->end_s;
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/gyro_track.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

namespace {

/// A sum of samples up to a place between two of them.
double sum_to(const std::vector<double>& sums, double place) {
  const auto left = std::min(static_cast<std::size_t>(place), sums.size() - 2);
  return std::lerp(sums[left], sums[left + 1], place - static_cast<double>(left));
}

/// Whether one of the samples that the gap lacks would have come at `begin` or later, but before `end`.
bool would_have_come(const ClockGap& gap, HostTime begin, HostTime end) {
  if (gap.missing == 0) return false;
  const double step_s = to_s(gap.end - gap.begin) / (static_cast<double>(gap.missing) + 1.0);
  const double before_begin = std::ceil(to_s(begin - gap.begin) / step_s);
  const double number = std::clamp(before_begin, 1.0, static_cast<double>(gap.missing));
  const HostTime first = gap.begin + from_s(number * step_s);
  return begin <= first && first < end;
}

constexpr double certain_periods = 10.0;
constexpr double most_periods = 1e9;
}  // namespace

bool lacks_sample(std::span<const ClockGap> gaps, HostTime begin, HostTime end) {
  const auto ends_before = [begin](const ClockGap& gap) { return gap.end <= begin; };
  for (auto gap = std::partition_point(gaps.begin(), gaps.end(), ends_before);
       gap != gaps.end() && gap->begin < end; ++gap)
    if (would_have_come(*gap, begin, end)) return true;
  return false;
}

void GyroTrack::add(const TimedGyro& gyro) {
  const float rate_dps = std::isfinite(gyro.rate_dps) ? gyro.rate_dps : 0.0F;
  points_.add({gyro.stamp.time, rate_dps, gyro.stamp.uncertainty_s, gyro.reading.saturated});
}

/// Samples stand evenly, each for the time up to the next, so the window may hold a part of one.
void GyroTrack::note_spread(GyroMean& mean, std::span<const Point> points) {
  const double length_s = to_s(points.back().time - points.front().time);
  const auto count = static_cast<double>(points.size());
  mean.spread_dps = mean.deviation_dps;
  if (points.size() < 2 || length_s <= 0.0) return;
  const double window = std::max(pulse_period_s * (count - 1.0) / length_s, 1.0);
  if (window >= count) return;
  std::vector<double> sums{0.0};
  sums.reserve(points.size() + 1);
  for (const Point& point : points) sums.push_back(sums.back() + static_cast<double>(point.rate_dps));
  const auto mean_to = [&](double to, double sum_before) { return (sum_to(sums, to) - sum_before) / window; };
  RunningStatistics smoothed, fast_dps2;
  std::size_t first = 0;
  for (double from = 0.0; from + window <= count; from += 1.0, ++first) {
    const double next = from + window, last = from + 2.0 * window;
    const double to_next = sum_to(sums, next);
    const double smooth_dps = (to_next - sums[first]) / window;
    smoothed.add(smooth_dps);
    mean.least_dps = std::fmin(mean.least_dps, smooth_dps);
    mean.most_dps = std::fmax(mean.most_dps, smooth_dps);
    if (from + 3.0 * window <= count)
      fast_dps2.add(alternation_dps2(smooth_dps, mean_to(next + window, to_next),
                                     mean_to(last + window, sum_to(sums, last))));
  }
  mean.spread_dps = std::sqrt(smoothed.variance());
  mean.averaged = window;
  if (count >= 3.0 * window) mean.fast_dps = std::sqrt(fast_dps2.mean() * window);
}

std::span<const GyroTrack::Point> GyroTrack::between(HostTime begin, HostTime end) const {
  const std::size_t first = points_.first_at_or_after(begin);
  const std::size_t last = std::max(points_.first_at_or_after(end), first);
  return points_.all().subspan(first, last - first);
}

double GyroTrack::mean_dps(HostTime begin, HostTime end) const {
  RunningStatistics samples;
  for (const Point& point : between(begin, end)) samples.add(static_cast<double>(point.rate_dps));
  return samples.count() > 0 ? samples.mean() : unknown;
}

GyroMean GyroTrack::over(HostTime begin, HostTime end) const {
  const std::span<const Point> points = between(begin, end);
  GyroMean mean;
  RunningStatistics samples;
  for (const Point& point : points) {
    samples.add(static_cast<double>(point.rate_dps));
    mean.saturated = mean.saturated || point.saturated;
    mean.time_uncertainty_s = std::max(mean.time_uncertainty_s, point.uncertainty_s);
  }
  mean.count = points.size();
  if (mean.count == 0) return mean;
  mean.rate_dps = samples.mean();
  mean.deviation_dps = std::sqrt(samples.variance());
  note_spread(mean, points);
  return mean;
}

bool GyroTrack::lacks_sample(HostTime begin, HostTime end, double period_s) const {
  const auto points = points_.all();
  for (std::size_t i = std::max<std::size_t>(points_.first_at_or_after(begin), 1);
       i < points.size() && points[i - 1].time < end; ++i) {
    const ClockGap silence{points[i - 1].time, points[i].time, 0};
    const double periods = std::min(to_s(silence.end - silence.begin) / period_s, most_periods);
    if (periods < certain_periods) continue;
    const auto missing = static_cast<std::uint64_t>(std::llround(periods)) - 1;
    if (would_have_come({silence.begin, silence.end, missing}, begin, end)) return true;
  }
  return false;
}

}  // namespace thermorig::labels

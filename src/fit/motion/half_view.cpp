// SPDX-License-Identifier: MIT
#include "half_view.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "thermorig/core/statistics.h"

namespace thermorig::motion {
namespace {

/// A rate may change unseen in a gap: at 2000 deg/s2, what a lost 40 ms can hide is a degree and a half.
constexpr double shortest_gap_s = 0.04;
constexpr double gap_periods = 3.5;

HalfExposure exposure_of(const TimedFrame& frame, unsigned parity, NewerHalf newer) {
  if (!newer) return frame.half[parity];
  const HostTime middle = frame.exposure_begin + (frame.exposure_end - frame.exposure_begin) / 2;
  return parity == *newer ? HalfExposure{middle, frame.exposure_end}
                          : HalfExposure{frame.exposure_begin, middle};
}

HalfView view_of(const FreshHalf& half) {
  HalfView view{.half = half, .temp_c = pixels_of(half.frame->frame, half.parity), .trust = {}};
  for (std::size_t i = 0; i < half_pixels; ++i) {
    const bool is_read = !std::isnan(view.temp_c[i]);
    if (!is_read) view.temp_c[i] = 0.0F;
    view.trust[i] = is_read ? 1.0F : 0.0F;
  }
  return view;
}

}  // namespace

AngleTrack::AngleTrack(std::span<const TimedGyro> gyro) : path_(gyro.size()) {
  if (gyro.empty()) return;
  origin_ = gyro.front().stamp.time;
  std::vector<Gap> steps;
  std::vector<double> lengths_s;
  for (const TimedGyro& sample : gyro) {
    const double time_s = seconds(sample.stamp.time);
    if (!is_rate(sample.rate_dps) || (path_.has_begun() && time_s <= path_.newest().time_s)) continue;
    if (path_.has_begun()) {
      steps.push_back({path_.newest().time_s, time_s});
      lengths_s.push_back(time_s - steps.back().begin_s);
    }
    path_.add(time_s, double{sample.rate_dps});
  }
  const double longest_s = std::max(shortest_gap_s, gap_periods * reordering_median(lengths_s));
  std::copy_if(steps.begin(), steps.end(), std::back_inserter(gaps_),
               [&](const Gap& step) { return step.end_s - step.begin_s > longest_s; });
}

double AngleTrack::mean_rate_dps() const {
  if (!path_.has_begun() || path_.newest().time_s <= path_.begin_s()) return 0.0;
  return path_.mean_over(path_.begin_s(), path_.newest().time_s).rate_dps;
}

std::optional<int> AngleTrack::stretch(double begin_s, double end_s) const {
  if (!path_.has_begun() || begin_s < path_.begin_s() || end_s > path_.newest().time_s) return std::nullopt;
  const auto over =
      std::partition_point(gaps_.begin(), gaps_.end(), [&](const Gap& gap) { return gap.end_s <= begin_s; });
  if (over != gaps_.end() && over->begin_s < end_s) return std::nullopt;
  return static_cast<int>(over - gaps_.begin());
}

std::vector<FreshHalf> fresh_halves(std::span<const TimedFrame> frames, const AngleTrack& track,
                                    double bias_dps, double margin_s, NewerHalf newer) {
  std::vector<FreshHalf> halves;
  for (const TimedFrame& frame : frames) {
    if (frame.late || frame.stale) continue;
    if (newer && !(frame.is_fresh(0) && frame.is_fresh(1))) continue;
    for (const unsigned parity : {0U, 1U}) {
      if (!frame.is_fresh(parity)) continue;
      const HalfExposure exposure = exposure_of(frame, parity, newer);
      if (!exposure.is_possible()) continue;
      const double begin_s = track.seconds(exposure.begin);
      const double end_s = track.seconds(exposure.end);
      const auto stretch = track.stretch(begin_s - margin_s, end_s + margin_s);
      if (!stretch) continue;
      const double rate_dps = track.path().mean_over(begin_s, end_s).rate_dps - bias_dps;
      const double third_s = (end_s - begin_s) / 3.0;
      const double change_dps = track.path().mean_over(end_s - third_s, end_s).rate_dps -
                                track.path().mean_over(begin_s, begin_s + third_s).rate_dps;
      halves.push_back({&frame, parity, begin_s, end_s, rate_dps, std::abs(change_dps), *stretch});
    }
  }
  return halves;
}

std::vector<FreshHalf> dealt_anew(std::span<const FreshHalf> halves, const AngleTrack& track,
                                  unsigned newer) {
  std::vector<FreshHalf> dealt(halves.begin(), halves.end());
  for (FreshHalf& half : dealt) {
    const HalfExposure exposure = exposure_of(*half.frame, half.parity, newer);
    half.begin_s = track.seconds(exposure.begin);
    half.end_s = track.seconds(exposure.end);
  }
  return dealt;
}

std::vector<HalfView> views_of(std::span<const FreshHalf> halves) {
  std::vector<HalfView> views;
  views.reserve(halves.size());
  for (const FreshHalf& half : halves) views.push_back(view_of(half));
  return views;
}

}  // namespace thermorig::motion

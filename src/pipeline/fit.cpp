// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numeric>

#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

namespace {
constexpr double most_periods = 1.5;  // between neighbours; more than that and frames are missing
constexpr double least_periods = 0.5;

std::vector<double> intervals_s(const std::vector<TimedFrame>& frames) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i)
    intervals.push_back(to_s(frames[i].stamp.time - frames[i - 1].stamp.time));
  return intervals;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The median alone is as coarse as the link's latency timer; the mean of what lies around it is not.
std::optional<double> period_s(const std::vector<TimedFrame>& frames) {
  std::vector<double> intervals = intervals_s(frames);
  if (intervals.empty()) return std::nullopt;
  const double middle = median(intervals);
  if (middle <= 0.0) return std::nullopt;
  std::erase_if(intervals, [middle](double interval) {
    return interval < least_periods * middle || interval > most_periods * middle;
  });
  return std::accumulate(intervals.begin(), intervals.end(), 0.0) / static_cast<double>(intervals.size());
}

std::optional<labels::CameraMode> camera_mode(const std::vector<TimedFrame>& frames) {
  labels::ModeVote vote;
  for (std::size_t i = 1; i < frames.size(); ++i)
    vote.push({.even = frames[i].fresh_even, .odd = frames[i].fresh_odd});
  if (vote.empty()) return std::nullopt;
  return vote.mode();
}
}  // namespace

Fits fit(const Streams& streams) {
  return {.camera_mode = camera_mode(streams.frames), .frame_period_s = period_s(streams.frames)};
}

}  // namespace thermorig::pipeline

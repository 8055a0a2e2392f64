// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

namespace {
constexpr double pause_periods = 4.0;  // between neighbours: no late read, frames are missing

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double interval_s(const TimedFrame& before, const TimedFrame& frame) {
  return to_s(frame.stamp.time - before.stamp.time);
}

double median_interval_s(const std::vector<TimedFrame>& frames) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i) intervals.push_back(interval_s(frames[i - 1], frames[i]));
  return median(std::move(intervals));
}

/// The frames' numbers, with gaps where some are missing: after skipped bytes, or after a long pause.
std::vector<double> numbers(const std::vector<TimedFrame>& frames, double about_s) {
  std::vector<double> result{0.0};
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double periods = interval_s(frames[i - 1], frames[i]) / about_s;
    const bool may_miss = frames[i].resync_before || periods > pause_periods;
    result.push_back(result.back() + (may_miss ? std::max(1.0, std::round(periods)) : 1.0));
  }
  return result;
}

/// The median interval alone is as coarse as the link's latency timer, and a mean suffers from late reads.
std::optional<double> period_s(const std::vector<TimedFrame>& frames) {
  if (frames.size() < 2) return std::nullopt;
  const double about_s = median_interval_s(frames);
  if (about_s <= 0.0) return std::nullopt;
  const std::vector<double> number = numbers(frames, about_s);
  const std::size_t half = frames.size() / 2;
  std::vector<double> slopes;
  for (std::size_t i = 0; i + half < frames.size(); ++i)
    slopes.push_back(interval_s(frames[i], frames[i + half]) / (number[i + half] - number[i]));
  return median(std::move(slopes));
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

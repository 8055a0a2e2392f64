// SPDX-License-Identifier: MIT
#include "camera_rhythm.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "thermorig/core/statistics.h"

namespace thermorig::fit {

namespace {
constexpr std::size_t short_span =
    16;  // of frames: half a tick in so many is no frame in the next longer span
constexpr auto by_time_alone =
    labels::CameraMode::full_fresh;  // where the halves tell nothing of missing frames

/// Median time a frame over all spans of `span` frames that have the numbers `number`.
double median_period_s(const std::vector<TimedFrame>& frames, const std::vector<double>& number,
                       std::size_t span) {
  std::vector<double> periods;
  std::size_t i = 0;
  for (const TimedFrame& frame : frames) {
    if (i >= span)
      periods.push_back(to_s(frame.stamp.time - frames[i - span].stamp.time) /
                        (number[i] - number[i - span]));
    ++i;
  }
  return median(std::move(periods));
}

/// The turn of each frame, missing ones counted.
std::vector<double> numbers(const std::vector<labels::FrameGap>& gaps) {
  std::vector<double> result;
  double number = 0.0;
  for (const labels::FrameGap& gap : gaps) result.push_back(number += 1.0 + gap.missing);
  return result;
}

/// First from frame to frame, where none is missing but a latency timer's ticks make it coarse; then, with
/// the missing frames counted, over a few, so that they can be counted over half the recording, where no tick
/// matters. The median forgets late reads.
/// None where most of it does not go forward.
std::optional<double> period_s(const std::vector<TimedFrame>& frames) {
  if (frames.size() < 2) return std::nullopt;
  const std::vector<labels::FrameGap> unbroken(frames.size());
  double period_s = median_period_s(frames, numbers(unbroken), 1);
  for (const std::size_t span : {std::min(short_span, frames.size() / 2), frames.size() / 2}) {
    if (period_s <= 0.0) return std::nullopt;
    period_s = median_period_s(frames, numbers(labels::find_gaps(frames, period_s, by_time_alone)), span);
  }
  return period_s > 0.0 ? std::optional(period_s) : std::nullopt;
}

std::optional<labels::CameraMode> camera_mode(const std::vector<TimedFrame>& frames) {
  labels::ModeVote vote;
  for (const TimedFrame& frame : frames)
    if (&frame != &frames.front()) vote.push({.even = frame.fresh_even, .odd = frame.fresh_odd});
  if (vote.empty()) return std::nullopt;
  return vote.mode();
}

/// Frames between two absences.
std::vector<std::vector<TimedFrame>> split(const std::vector<TimedFrame>& frames,
                                           std::span<const std::size_t> begins) {
  std::vector<std::vector<TimedFrame>> pieces;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : frames.size();
    pieces.emplace_back(frames.begin() + static_cast<std::ptrdiff_t>(begins[i]),
                        frames.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return pieces;
}

CameraRhythm rhythm_of_pieces(const std::vector<std::vector<TimedFrame>>& pieces, CameraRhythm rhythm) {
  const auto& longest = *std::max_element(pieces.begin(), pieces.end(),
                                          [](const auto& a, const auto& b) { return a.size() < b.size(); });
  rhythm.period_s = period_s(longest);
  if (!rhythm.period_s) return rhythm;
  const auto mode = rhythm.mode.value_or(labels::CameraMode::half_fresh);
  const std::vector<TimedFrame>* before = nullptr;
  for (const std::vector<TimedFrame>& piece : pieces) {
    std::vector<labels::FrameGap> gaps = labels::find_gaps(piece, *rhythm.period_s, mode);
    if (before != nullptr)
      gaps.front() = {.missing = labels::missing_in_absence(before->back().stamp.time,
                                                            piece.front().stamp.time, *rhythm.period_s),
                      .late = false};
    rhythm.gaps.insert(rhythm.gaps.end(), gaps.begin(), gaps.end());
    before = &piece;
  }
  return rhythm;
}
}  // namespace

CameraRhythm camera_rhythm(const std::vector<TimedFrame>& frames, std::span<const std::size_t> pieces) {
  CameraRhythm rhythm{.mode = camera_mode(frames), .period_s = {}, .gaps = {}};
  if (pieces.size() > 1) return rhythm_of_pieces(split(frames, pieces), std::move(rhythm));
  rhythm.period_s = period_s(frames);
  const auto mode = rhythm.mode.value_or(labels::CameraMode::half_fresh);
  if (rhythm.period_s) rhythm.gaps = labels::find_gaps(frames, *rhythm.period_s, mode);
  return rhythm;
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include "frame_gaps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace thermorig::fit {

using namespace labels;

namespace {
constexpr double late_limit_periods = 0.5;
constexpr std::size_t queue_frames =
    48;  // what a port's buffers hold at most: 64 kB of 1.5 kB frames, rounded up
constexpr std::size_t soon_frames = 2;        // so long a busy host may keep what is read
constexpr double schedule_gain = 0.1;         // how fast the schedule follows frames that are a little late
constexpr std::size_t confirming_frames = 4;  // late in a row, before frames are called missing
constexpr auto most_missing = static_cast<double>(std::numeric_limits<std::uint16_t>::max());

std::uint16_t whole_periods(double periods) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(periods, 0.0, most_missing)));
}

/// Time of each frame minus its turn in an unbroken sequence: level where all is well, a bump where reads
/// were late, a step up where frames are missing.
std::vector<double> delays_s(const std::vector<TimedFrame>& frames, double period_s) {
  std::vector<double> delays;
  delays.reserve(frames.size());
  for (const TimedFrame& frame : frames)
    delays.push_back(to_s(frame.stamp.time - frames.front().stamp.time) -
                     period_s * static_cast<double>(delays.size()));
  return delays;
}

/// The least delay of each frame and those that could have queued up behind it: the level without the bumps.
std::vector<double> levels_s(const std::vector<double>& delays) {
  std::vector<double> levels(delays.size());
  for (std::size_t i = 0; i < delays.size(); ++i) {
    const auto first = delays.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last = delays.begin() + static_cast<std::ptrdiff_t>(std::min(i + queue_frames, delays.size()));
    levels[i] = *std::min_element(first, last);
  }
  return levels;
}

std::vector<HalvesWitness> witnesses_of(const std::vector<TimedFrame>& frames, CameraMode mode) {
  HalvesOrder order;
  std::vector<HalvesWitness> witnesses;
  witnesses.reserve(frames.size());
  for (const TimedFrame& frame : frames)
    witnesses.push_back(order.push({.even = frame.fresh_even, .odd = frame.fresh_odd}, mode));
  return witnesses;
}

/// How many of the next frames say by their halves that something is missing before them.
int claimed_soon(const std::vector<HalvesWitness>& witnesses, std::size_t after) {
  const std::size_t end = std::min(after + 1 + soon_frames, witnesses.size());
  int claimed = 0;
  for (std::size_t i = after + 1; i < end; ++i) claimed += may_be_missing(witnesses[i]);
  return claimed;
}

/// Whether more is missing before one of the next frames, by their time, or may be, since none come.
bool may_rise_soon(const std::vector<double>& levels, std::size_t from, double period_s) {
  if (from + confirming_frames > levels.size()) return true;
  return levels[from + soon_frames] - levels[from] > late_limit_periods * period_s;
}

/// What may be missing before one of the next frames rather than here.
struct Soon {
  int claimed = 0;        // how many of them say by their halves that something is
  bool may_rise = false;  // their time says it
};

/// The time says how many are missing, and the halves say where: an even number where they take turns, an odd
/// one where the same half comes again. What fits here may be missing before one of the next frames, where
/// these say so.
std::uint16_t missing_here(int owed, HalvesWitness halves, const Soon& soon, bool is_late) {
  const bool may_wait = soon.claimed > 0 || soon.may_rise;
  int missing = owed;
  if (halves == HalvesWitness::none_missing && is_late)
    missing = std::max(0, owed - soon.claimed) / 2 * 2;
  else if (halves == HalvesWitness::none_missing && may_wait)
    missing = owed / 2 * 2;
  else if (halves == HalvesWitness::due_half_missing && may_wait && owed > 0)
    missing = (owed - 1) / 2 * 2 + 1;
  const int least = halves == HalvesWitness::frames_missing ? 1 : 0;
  return static_cast<std::uint16_t>(std::clamp(missing, least, static_cast<int>(most_missing)));
}
}  // namespace

std::vector<FrameGap> find_gaps(const std::vector<TimedFrame>& frames, double period_s, CameraMode mode) {
  assert(period_s > 0.0);
  const std::vector<double> delays = delays_s(frames, period_s);
  const std::vector<double> levels = levels_s(delays);
  std::vector<FrameGap> gaps(frames.size());
  const std::vector<HalvesWitness> witnesses = witnesses_of(frames, mode);
  int owed = 0;  // frames that the schedule misses and that have no place yet; below 0: placed before it did
  double settled_s = frames.empty() ? 0.0 : levels.front();  // the level, but for what is owed since
  for (std::size_t i = 1; i < frames.size(); ++i) {
    // The last frames may only be late: nothing comes after them that would show it.
    const bool is_told =
        i + confirming_frames <= frames.size() || witnesses[i] == HalvesWitness::due_half_missing;
    // Reads that come late before a loss share its step among them.
    const double risen_s = levels[i] - settled_s;
    const Soon soon{claimed_soon(witnesses, i), may_rise_soon(levels, i, period_s)};
    const int lost = is_told ? whole_periods(risen_s / period_s) : 0;
    settled_s += lost * period_s + schedule_gain * (risen_s - lost * period_s);
    owed += lost;
    gaps[i].late = delays[i] - (is_told ? levels[i] : settled_s) > late_limit_periods * period_s;
    gaps[i].missing = missing_here(owed, witnesses[i], soon, gaps[i].late);
    owed -= gaps[i].missing;
  }
  return gaps;
}

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/frame_gaps.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

namespace {
constexpr double late_limit_periods = 0.5;
constexpr std::size_t queue_frames =
    48;  // what a port's buffers hold at most: 64 kB of 1.5 kB frames, rounded up
constexpr std::size_t soon_frames = 2;  // so long a busy host may keep what is read
constexpr double schedule_gain = 0.1;   // how fast the live schedule follows frames that are a little late
constexpr double catching_up_gain =
    0.5;  // the same for the last of those that queued up, nearly on time again
constexpr std::size_t least_intervals = 4;    // before a measured period is believed
constexpr std::size_t confirming_frames = 4;  // late in a row, before frames are called missing
constexpr double confirming_s = 0.5;          // the same of a fast camera's, at least
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

LiveFrameGaps::LiveFrameGaps(double frame_period_s) : period_s_(frame_period_s) {
  assert(frame_period_s > 0.0);
}

/// What queued up comes at once.
bool LiveFrameGaps::catches_up(HostTime time) const {
  return to_s(time - *before_) < late_limit_periods * period_s_;
}

/// The median of the last intervals: a late read or a missing frame among them does not move it. Frames that
/// came together share the time since the one ahead of them, and less than half of the places.
void LiveFrameGaps::learn_period(HostTime time) {
  if (!catches_up(time)) {
    queue_begin_ = *before_;
    queue_length_ = 0;
  }
  ++queue_length_;
  const std::size_t places = std::min(queue_length_, kept_intervals / 2);
  if (places == queue_length_) ++interval_count_;
  const double shared_s = to_s(time - queue_begin_) / static_cast<double>(queue_length_);
  for (std::size_t i = 1; i <= places; ++i) intervals_s_[(interval_count_ - i) % kept_intervals] = shared_s;
  if (interval_count_ < least_intervals) return;
  const std::size_t count = std::min(interval_count_, kept_intervals);
  std::array<double, kept_intervals> sorted = intervals_s_;
  const double usual_s = reordering_median(std::span(sorted).first(count));
  if (usual_s > 0.0) period_s_ = usual_s;
}

std::uint16_t LiveFrameGaps::missing(double late_periods, const TimedFrame& frame, HalvesWitness halves) {
  const bool stays_late = late_periods > late_limit_periods && !catches_up(frame.stamp.time);
  late_frames_ = stays_late ? late_frames_ + 1 : 0;
  // A system that is late is so for a time, not for a number of frames.
  const auto confirming = std::max(confirming_frames, static_cast<std::size_t>(confirming_s / period_s_));
  std::size_t patience =
      halves == HalvesWitness::none_missing ? std::max(queue_frames, confirming) : confirming;
  // Of a bridge that misses halves: two in a row.
  const bool may_be_two = left_out_.is_frequent() && late_periods > 2.0 - late_limit_periods;
  if (may_be_two && halves == HalvesWitness::none_missing) patience = 1;
  // The half that was due never came: only the time says whether a frame of it did.
  const bool is_told =
      halves == HalvesWitness::frames_missing || (halves == HalvesWitness::due_half_missing && stays_late);
  left_out_.add(is_told && !frame.resync_before);
  if (!is_told && late_frames_ < patience) return 0;
  late_frames_ = 0;
  return std::max<std::uint16_t>(whole_periods(late_periods), 1);
}

FrameGap LiveFrameGaps::push(const TimedFrame& frame, HalvesWitness halves) {
  const HostTime time = frame.stamp.time;
  FrameGap gap;
  double late_periods = 0.0;
  double gain = schedule_gain;
  if (before_) {
    learn_period(time);
    if (catches_up(time)) gain = catching_up_gain;
    late_periods = to_s(time - expected_) / period_s_;
    gap.missing = missing(late_periods, frame, halves);
    late_periods -= gap.missing;
    gap.late = late_periods > late_limit_periods;
  }
  // A little late: the schedule follows slowly. Very late: a stall, which says nothing about the schedule,
  // but for the last of those that queued up.
  const bool is_stalled = late_periods > (gain > schedule_gain ? 1.0 : late_limit_periods);
  const double kept_periods = is_stalled ? late_periods : (1.0 - gain) * std::max(0.0, late_periods);
  expected_ = time + from_s((1.0 - kept_periods) * period_s_);
  before_ = time;
  return gap;
}

std::uint16_t missing_in_absence(HostTime last, HostTime first, double period_s) {
  constexpr double most = std::numeric_limits<std::uint16_t>::max();
  const double periods = std::round(to_s(first - last) / period_s) - 1.0;
  return static_cast<std::uint16_t>(std::clamp(periods, 1.0, most));
}

}  // namespace thermorig::labels

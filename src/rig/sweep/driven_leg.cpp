// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/driven_leg.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "thermorig/core/statistics.h"

namespace thermorig::rig {

void DrivenLeg::acknowledge(HostTime time) {
  acknowledged_ = true;
  record_.begin = time;
}

void DrivenLeg::seen(HostTime time) {
  if (!first_seen_) first_seen_ = time;
  last_seen_ = time;
}

void DrivenLeg::broke_off() {
  while (!counted_.empty() && (!last_seen_ || counted_.back().middle > *last_seen_)) counted_.pop_back();
  note_counted();
}

void DrivenLeg::take_back() {
  counted_.pop_back();
  note_counted();
}

void DrivenLeg::note_counted() {
  record_.frames = static_cast<decltype(record_.frames)>(counted_.size());
  if (!counted_.empty()) record_.end = counted_.back().arrival;
}

// A frame belongs to the leg in which the middle of its newest half was exposed, as its label says.
void DrivenLeg::frame(HostTime middle, HostTime arrival, HostDuration doubt) {
  if (left_ && middle + doubt > *left_) over_ = true;
  if (over_ || !first_seen_ || middle < *first_seen_ + doubt) return;
  counted_.push_back({middle, arrival});
  note_counted();
}

void DrivenLeg::keep_direction(double driven_dps) {
  if (turn_back_ && driven_dps != 0.0) run_rate_dps_ = std::copysign(run_rate_dps_, driven_dps);
}

LegRecord DrivenLeg::closed(HostTime now) const {
  LegRecord record = record_;
  record.complete = is_whole();
  if (!acknowledged_) record.begin = now;
  if (record.frames == 0) record.end = now;
  return record;
}

void LeftLeg::frame(HostTime middle, HostTime arrival, HostDuration doubt, HostDuration delay) {
  if (!leg_.is_over()) {
    leg_.frame(middle, arrival, doubt);
    last_is_late_ = leg_.missing() <= 0 && arrival > left_ + delay;
  }
  if (++frames_ > 1) last_is_late_ = false;
}

DrivenLeg LeftLeg::settled() const {
  DrivenLeg leg = leg_;
  if (last_is_late_) leg.take_back();
  return leg;
}

namespace {
constexpr std::size_t frames_kept = 16;
constexpr std::size_t frames_needed = 8;      // before the measured rate replaces the nominal one
constexpr std::size_t frames_predicting = 4;  // the latest: an error of the period adds up over them
constexpr double forgotten = 0.01;            // at each frame
constexpr std::uint16_t missed_at_once = 4;   // more: the camera was away, and is back
constexpr double half_way_tolerance = 0.15;   // periods: more than a tick
}  // namespace

HostTime newest_middle(const TimedFrame& frame) {
  return frame.exposure_end - (frame.exposure_end - frame.exposure_begin) / 4;
}

void FrameSchedule::frame(const TimedFrame& frame) {
  const std::int64_t number = seen_.empty() ? 0 : seen_.back().number + 1 + frame.missing_before;
  seen_.push_back({newest_middle(frame), frame.stamp.arrival, number});
  if (seen_.size() > frames_kept) seen_.pop_front();
  came_ += 1.0 - forgotten * came_;
  missed_ -= forgotten * missed_;
  if (frame.missing_before <= missed_at_once) missed_ += frame.missing_before;
}

// Over half of the frames at a time: a latency timer makes single intervals coarse. The median, since a read
// may be late.
double FrameSchedule::rate_hz() const {
  if (seen_.size() < frames_needed) return nominal_rate_hz_;
  const std::size_t half = seen_.size() / 2;
  std::vector<double> periods_s;
  for (std::size_t i = 0; i + half < seen_.size(); ++i)
    periods_s.push_back(to_s(seen_[i + half].middle - seen_[i].middle) /
                        static_cast<double>(seen_[i + half].number - seen_[i].number));
  const double period_s = reordering_median(periods_s);
  return period_s > 0.0 ? 1.0 / period_s : nominal_rate_hz_;
}

// A read can be late but never early: the earliest that one of the latest frames foretells is right.
HostTime FrameSchedule::next_middle() const {
  assert(!seen_.empty());
  const HostDuration period = this->period();
  const std::int64_t next = seen_.back().number + 1;
  const std::size_t first = seen_.size() - std::min(seen_.size(), frames_predicting);
  HostTime earliest = seen_.back().middle + period;
  for (std::size_t i = first; i < seen_.size(); ++i)
    earliest = std::min(earliest, seen_[i].middle + (next - seen_[i].number) * period);
  return earliest;
}

bool FrameSchedule::is_between_frames(HostTime now) const {
  if (seen_.empty()) return true;
  const double phase = std::abs(to_s(now - next_middle())) * rate_hz();
  return std::abs(phase - std::floor(phase) - 0.5) < half_way_tolerance;
}

HostDuration FrameSchedule::delay() const {
  assert(!seen_.empty());
  const auto delay_of = [](const Seen& seen) { return seen.arrival - seen.middle; };
  HostDuration least = delay_of(seen_.back());
  for (const Seen& seen : seen_) least = std::min(least, delay_of(seen));
  return least;
}

}  // namespace thermorig::rig

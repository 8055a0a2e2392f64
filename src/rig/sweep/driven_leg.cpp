// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/driven_leg.h"

#include <cmath>

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

}  // namespace thermorig::rig

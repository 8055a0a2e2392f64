// SPDX-License-Identifier: MIT
#include "thermorig/rig/live_replay.h"

#include <utility>

namespace thermorig::rig {

LiveReplay::LiveReplay(const RawRecording& raw)
    : raw_(raw), replay_(raw), gone_(camera_gone()), coming_(replay_.next()) {}

std::optional<HostTime> LiveReplay::camera_gone() const {
  for (const RecordingEvent& event : raw_.events)
    if (event.kind == EventKind::missing && event.source == Device::camera) return event.time;
  return std::nullopt;
}

std::optional<pipeline::ReplayMoment> LiveReplay::next() {
  if (!coming_) return std::nullopt;
  std::optional<pipeline::ReplayMoment> moment = std::exchange(coming_, std::nullopt);
  coming_ = replay_.next();
  if (gone_ && moment->time > *gone_) stand_in(*moment);
  pairs_seen_ += moment->pairs.size();
  return moment;
}

// As Recording does it: what a camera sends that is back is kept, and no more.
void LiveReplay::stand_in(pipeline::ReplayMoment& moment) {
  if (!absent_camera_) absent_camera_.emplace(raw_.header.profile, *gone_);
  const bool is_end = !coming_;
  if (is_end)
    absent_camera_->finish();
  else if (moment.from)  // what was sent says nothing of time
    absent_camera_->add(moment.streams, moment.time, pairs_seen_);
  absent_camera_->take_frames();  // no sweep is driven by them
  std::vector<pipeline::FramePair> pairs = absent_camera_->take_pairs();
  if (!absent_camera_->has_begun()) return;
  moment.pairs = std::move(pairs);
}

}  // namespace thermorig::rig

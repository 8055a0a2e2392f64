// SPDX-License-Identifier: MIT
#include "replay_progress.h"

#include <algorithm>

#include "thermorig/rig/sweep/plan.h"

namespace thermorig::app {

std::vector<RecordingEvent> ReplayProgress::take_events(HostTime now) {
  std::vector<RecordingEvent> events;
  for (; events_taken_ < raw_.events.size() && raw_.events[events_taken_].time <= now; ++events_taken_)
    events.push_back(raw_.events[events_taken_]);
  return events;
}

void ReplayProgress::note_gone(const RecordingEvent& event) {
  if (!event.source) return;
  if (event.kind == EventKind::missing) gone_[*event.source] = true;
  if (event.kind == EventKind::device_back) gone_[*event.source] = false;
}

void ReplayProgress::add(const pipeline::ReplayMoment& moment) {
  for (const TimedFrame& frame : moment.streams.frames) {
    meters_[Device::camera].message(moment.time);
    uncertainty_s_[Device::camera] = frame.stamp.uncertainty_s;
    missing_frames_ += frame.missing_before;
  }
  for (const TimedGyro& gyro : moment.streams.gyro) {
    meters_[Device::gyro].message(moment.time);
    uncertainty_s_[Device::gyro] = gyro.stamp.uncertainty_s;
  }
  for (const TimedServo& servo : moment.streams.servo) {
    meters_[Device::servo].message(moment.time);
    uncertainty_s_[Device::servo] = servo.stamp.uncertainty_s;
  }
}

void ReplayProgress::add(const LabelledSample& sample) {
  frames_in_leg_ = last_sample_ && last_sample_->leg == sample.leg ? frames_in_leg_ + 1 : 1;
  last_sample_ = sample;
}

rig::SweepProgress ReplayProgress::sweep(HostTime now) const {
  rig::SweepProgress sweep;
  const double whole_s = to_s(raw_.end_time - raw_.header.time_reference);
  const double passed_s = to_s(now - raw_.header.time_reference);
  sweep.done_share = whole_s > 0.0 ? std::clamp(passed_s / whole_s, 0.0, 1.0) : 1.0;
  sweep.eta_s = std::max(0.0, whole_s - passed_s);
  sweep.leg_count = static_cast<int>(raw_.legs.size());
  sweep.frames_per_leg = raw_.header.frames_per_leg;
  const auto leg = std::find_if(raw_.legs.begin(), raw_.legs.end(), [&](const LegRecord& record) {
    return record.begin <= now && now < record.end;
  });
  if (leg == raw_.legs.end()) {
    sweep.phase = now < raw_.end_time ? rig::SweepPhase::transit : rig::SweepPhase::done;
    return sweep;
  }
  sweep.phase = rig::SweepPhase::leg;
  sweep.leg = leg->leg;
  sweep.rate_dps = leg->rate_dps;
  if (std::next(leg) != raw_.legs.end()) sweep.next_rate_dps = std::next(leg)->rate_dps;
  if (last_sample_ && last_sample_->leg == leg->leg) sweep.frames = frames_in_leg_;
  return sweep;
}

rig::RecordingProgress ReplayProgress::at(HostTime now, const pipeline::CausalReplay& replay) {
  rig::RecordingProgress progress;
  progress.time = now;
  progress.elapsed_s = to_s(now - raw_.header.time_reference);
  progress.sweep = sweep(now);
  for (const Device device : all_devices) {
    progress.health[device] = meters_[device].health(now, replay.counters(device));
    progress.health[device].expected_hz = rig::link_load(device, raw_.header.profile).rate_hz;
    progress.health[device].uncertainty_s = uncertainty_s_[device];
  }
  progress.health[Device::camera].lost += missing_frames_;
  progress.events = take_events(now);
  for (const RecordingEvent& event : progress.events) note_gone(event);
  progress.last_sample = last_sample_;
  progress.gone = gone_;
  return progress;
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/exposure.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace thermorig::labels {

HalvesWitness HalvesOrder::push(const Freshness& freshness, CameraMode mode) {
  const Freshness before = std::exchange(before_, freshness);
  if (mode != CameraMode::half_fresh) return HalvesWitness::unsure;
  if (before.none_fresh() || freshness.none_fresh()) return HalvesWitness::unsure;
  if (freshness.both_fresh()) return HalvesWitness::frames_missing;
  if (before.both_fresh()) return HalvesWitness::unsure;
  return before.even_fresh() == freshness.even_fresh() ? HalvesWitness::due_half_missing
                                                       : HalvesWitness::none_missing;
}

void ModeVote::push(const Freshness& freshness) {
  if (freshness.both_fresh()) ++full_;
  if (freshness.one_fresh()) ++half_;
}

ExposureRule::ExposureRule(double frame_period_s, std::optional<CameraMode> mode,
                           std::optional<unsigned> newer_half)
    : frame_period_(from_s(frame_period_s)), mode_(mode), newer_half_(newer_half) {
  assert(frame_period_s > 0.0);
  assert(!newer_half || *newer_half < 2);
}

bool ExposureRule::is_stale(const Freshness& freshness) {
  if (freshness.both_fresh()) {
    last_single_ = Half::none;
    return false;
  }
  if (freshness.none_fresh()) return true;
  const Half single = freshness.even_fresh() ? Half::even : Half::odd;
  const bool repeated = single == last_single_;
  last_single_ = single;
  return repeated || mode() == CameraMode::full_fresh;
}

/// Of a frame with a fresh half: the half that was exposed last.
std::optional<unsigned> ExposureRule::newest_half(const Freshness& freshness, HostTime time) const {
  if (mode() == CameraMode::full_fresh) return newer_half_;
  if (freshness.one_fresh()) return freshness.even_fresh() ? 0U : 1U;
  if (!newest_) return std::nullopt;
  const auto periods = std::llround(to_s(time - newest_time_) / to_s(frame_period_));
  return static_cast<unsigned>((*newest_ + periods) & 1);
}

void ExposureRule::note_newest(const Freshness& freshness, HostTime time) {
  if (!freshness.one_fresh()) return;
  newest_ = freshness.even_fresh() ? 0U : 1U;
  newest_time_ = time;
}

void ExposureRule::expose_halves(const Freshness& freshness, TimedFrame& frame) {
  const HostTime begin = frame.exposure_begin, end = frame.exposure_end;
  const HostTime middle = begin + (end - begin) / 2;
  const std::optional<unsigned> newest = newest_half(freshness, end);
  for (unsigned half = 0; half < 2; ++half) {
    const HalfExposure older{begin, middle}, newer{middle, end}, either{begin, end};
    const HalfExposure now = !newest ? either : half == *newest ? newer : older;
    if ((half == 0 ? freshness.even_fresh() : freshness.odd_fresh()) || !half_[half]) half_[half] = now;
    frame.half[half] = *half_[half];
  }
}

HalvesWitness ExposureRule::look(TimedFrame& frame) {
  freshness_ = {frame.fresh_even, frame.fresh_odd};
  if (looked_++ > 0) vote_.push(freshness_);
  frame.stale = is_stale(freshness_);
  frame.half_lost = frame.stale && freshness_.one_fresh() && mode() == CameraMode::half_fresh;
  return order_.push(freshness_, mode());
}

void ExposureRule::expose(TimedFrame& frame) {
  if (looked_ > 1) note_newest(freshness_, frame.stamp.time);
  frame.exposure_end = frame.stamp.time;
  frame.exposure_begin = frame.stamp.time - (mode() == CameraMode::half_fresh ? 2 : 1) * frame_period_;
  expose_halves(freshness_, frame);
}

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "thermorig/labels/exposure.h"

#include <cassert>

namespace thermorig::labels {

ExposureRule::ExposureRule(double frame_period_s, std::optional<CameraMode> mode)
    : frame_period_(from_s(frame_period_s)), mode_(mode) {
  assert(frame_period_s > 0.0);
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

void ExposureRule::apply(TimedFrame& frame) {
  const Freshness freshness = detector_.push(frame.frame);
  if (!first_) vote_.push(freshness);
  first_ = false;
  frame.fresh_even = freshness.even;
  frame.fresh_odd = freshness.odd;
  frame.stale = is_stale(freshness);
  frame.exposure_end = frame.stamp.time;
  frame.exposure_begin = frame.stamp.time - (mode() == CameraMode::half_fresh ? 2 : 1) * frame_period_;
}

}  // namespace thermorig::labels

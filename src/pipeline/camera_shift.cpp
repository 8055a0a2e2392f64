// SPDX-License-Identifier: MIT
#include "camera_shift.h"

#include <cmath>

namespace thermorig::pipeline {

void apply_camera_offset(const RigProfile& profile, CameraOffset& offset, ClockFit& camera) {
  if (!offset.offset_s || camera.times.empty()) return;
  const double assumed = profile.camera.link.latency_uncertainty_s;
  const double seen = std::hypot(offset.offset_s->uncertainty, profile.gyro.link.latency_uncertainty_s);
  if (!(seen < assumed)) return;
  const double share = assumed * assumed / (assumed * assumed + seen * seen);
  const double shift_s = share * offset.offset_s->value;
  for (TimeEstimate& estimate : camera.times) estimate.time -= from_s(shift_s);
  camera.report.latency_s += shift_s;
  camera.report.latency_uncertainty_s = seen * std::sqrt(share);
  offset.applied = true;
}

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#include "shaft_angles.h"

#include <cmath>
#include <span>

#include "thermorig/core/validity.h"
#include "thermorig/pipeline/labels/label_config.h"
#include "thermorig/pipeline/labels/servo_response.h"
#include "thermorig/pipeline/labels/shaft_track.h"

namespace thermorig::interchange {

namespace {

labels::ShaftTrack track_of(const session::Session& session) {
  const ServoProfile& servo = session.raw.header.profile.servo;
  const labels::LabelConfig config;
  return {servo, session.sync.servo.fitted ? session.sync.servo : labels::assumed_response(servo),
          from_s(config.telemetry_gap_s), from_s(config.history_s)};
}

}  // namespace

std::vector<AngleAt> shaft_angles(const session::Session& session) {
  const HostTime reference = session.raw.header.time_reference;
  labels::ShaftTrack track = track_of(session);
  std::span left(session.servo);
  std::vector<AngleAt> angles;
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const HostTime time = session.frames[i].exposure_end;
    if (!is_of_recording(time, reference)) continue;
    for (; !left.empty() && !track.reaches(time); left = left.subspan(1))
      if (is_of_recording(left.front().stamp.time, reference)) track.add(left.front());
    const bool is_lost = (session.samples[i].reason_bits & bit(Reason::servo_lost)) != 0;
    if (is_lost || !track.covers(time, time)) continue;
    const double angle_deg = track.at(time).scaled_deg;
    if (std::isfinite(angle_deg)) angles.push_back({time, angle_deg});
  }
  return angles;
}

}  // namespace thermorig::interchange

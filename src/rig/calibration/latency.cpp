// SPDX-License-Identifier: MIT
#include <algorithm>

#include "thermorig/core/error.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double least_turning_dps = 10.0;  // beyond any bias that is not known
constexpr const char* scene_advice =
    "point the camera at something with warm and cold edges; if it is, try `thermorig calibrate orientation` "
    "first";
constexpr const char* motion_advice =
    "a session that turns back and forth: `thermorig calibrate latency` without --session records one; if it "
    "did, see that the servo has its supply and the gyro sits on the arm";

bool turned_both_ways(const session::Session& session) {
  const double bias_dps = session.sync.gyro.bias_dps ? session.sync.gyro.bias_dps->value : 0.0;
  const auto turns = [&](double sign) {
    return std::any_of(session.gyro.begin(), session.gyro.end(), [&](const TimedGyro& sample) {
      return sign * (sample.rate_dps - bias_dps) > least_turning_dps;
    });
  };
  return turns(1.0) && turns(-1.0);
}

}  // namespace

/// The session's times may have been shifted by its own estimate already: what was really subtracted is in
/// its clock's report, and the images tell what is left of it.
LatencyResult measure_latency(const session::Session& session) {
  const RigProfile& profile = session.raw.header.profile;
  const motion::View view{profile.camera.lens_width_deg(), profile.camera.mirrored};
  const CameraOffset left = motion::camera_offset(session.frames, session.gyro, view, session.sync.gyro);
  if (!left.offset_s)
    throw Error(ExitCode::finished_lossy, "the camera's delay cannot be measured: " + left.why_not,
                "calibrate latency", turned_both_ways(session) ? scene_advice : motion_advice);
  const double subtracted_s = session.sync.clock[Device::camera].latency_s;
  const double latency_s = subtracted_s + left.offset_s->value;
  const double before_s = profile.camera.link.latency_s;
  const double uncertainty_s = left.offset_s->uncertainty;
  return {.camera_latency_s = {latency_s, uncertainty_s},
          .before_s = before_s,
          .offset_s = {latency_s - before_s, uncertainty_s},
          .halves = left.halves};
}

}  // namespace thermorig::calibration

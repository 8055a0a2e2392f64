// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/session/session.h"

namespace thermorig::calibration {

// Each takes a finished session that was recorded for it (or any other that happens to show what is needed),
// and says what it found; apply() writes it into a rig profile, with the date. Throw Error(finished_lossy)
// with the reason where the session cannot tell.

/// 60 s at rest: the gyro's bias about the servo's axis and its uncertainty (spread among parts, drift
/// included).
struct BiasResult {
  Estimate bias_dps;
  double noise_dps = 0.0;
  double rest_s = 0.0;
  bool zeroes_itself = false;
};
BiasResult measure_bias(const session::Session& session);

/// Sweeps back and forth: how much longer the camera takes than the profile says, against the gyro.
struct LatencyResult {
  Estimate camera_latency_s;  // new value for the profile: old one plus the measured offset
  double before_s = 0.0;
};
LatencyResult measure_latency(const session::Session& session);

/// A whole turn that closes in the image, by the servo (winch, continuous) or by hand: the gyro's scale, and
/// with it the servo's where the servo drove.
struct ScaleResult {
  Estimate gyro_scale;
  std::optional<Estimate> servo_scale;
  double turned_deg = 0.0;
};
ScaleResult measure_scale(const session::Session& session);

/// The same without an image: the rig was turned by `angle_deg` between marks by hand, from rest to rest.
ScaleResult measure_scale_by_marks(const session::Session& session, double angle_deg);

/// Which way is positive: the gyro's sign against the commands, the image against the gyro.
struct OrientationResult {
  int gyro_axis = 2;  // the axis that turns with the servo
  int gyro_sign = 1;
  bool mirrored = true;
};
OrientationResult measure_orientation(const session::Session& session);

void apply(const BiasResult& result, const std::string& utc, RigProfile& profile);
void apply(const LatencyResult& result, const std::string& utc, RigProfile& profile);
void apply(const ScaleResult& result, const std::string& utc, RigProfile& profile);
void apply(const OrientationResult& result, const std::string& utc, RigProfile& profile);

}  // namespace thermorig::calibration

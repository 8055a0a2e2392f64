// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "rest.h"
#include "thermorig/core/error.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "thermorig/fit/shaft/servo_response.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double potentiometer_linearity = 0.01;  // of the cheap ones

/// The session's, with a bias that is not fooled by hands on a rig whose servo stands still.
GyroErrors errors_of(const session::Session& session) {
  GyroErrors errors = session.sync.gyro;
  if (const auto resting = resting_gyro(session.servo, session.gyro); resting && !errors.zeroes_itself)
    errors.bias_dps = Estimate{resting->bias_dps, resting->spread_dps};
  return errors;
}

/// Share of the servo's travel (continuous: of its speeds) that the session drove.
double driven_share(const session::Session& session) {
  const ServoProfile& servo = session.raw.header.profile.servo;
  double low_deg = 0.0, high_deg = 0.0, fastest_dps = 0.0;
  bool any = false;
  for (const TimedServo& message : session.servo) {
    if (message.state.leg == 0) continue;
    const double angle_deg = message.state.angle_deg;
    low_deg = any ? std::min(low_deg, angle_deg) : angle_deg;
    high_deg = any ? std::max(high_deg, angle_deg) : angle_deg;
    fastest_dps = std::max(fastest_dps, std::abs(message.state.rate_dps));
    any = true;
  }
  const double share = servo.kind == ServoKind::continuous ? fastest_dps / servo.full_rate_dps
                                                           : (high_deg - low_deg) / servo.travel_deg;
  return std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
}

/// The profile's scale is to hold for the whole travel, and a servo's potentiometer is no straighter than its
/// data sheet says: where it was not driven, the slope may differ.
std::optional<Estimate> servo_scale(const session::Session& session, GyroErrors errors,
                                    const Estimate& gyro_scale) {
  errors.scale = gyro_scale;
  errors.scale_calibrated = true;
  const ServoResponse response =
      fit::fit_servo_response(session.servo, session.gyro, errors, session.raw.header.profile.servo);
  if (!response.fitted || !response.scale_calibrated) return std::nullopt;
  const double elsewhere = potentiometer_linearity * (1.0 - driven_share(session));
  return Estimate{response.scale.value, std::hypot(response.scale.uncertainty, elsewhere)};
}

}  // namespace

ScaleResult measure_scale(const session::Session& session) {
  const CameraProfile& camera = session.raw.header.profile.camera;
  const GyroErrors errors = errors_of(session);
  const motion::TurnResult turn =
      motion::gyro_scale(session.frames, session.gyro, {camera.lens_width_deg(), camera.mirrored}, errors);
  if (!turn.gyro_scale)
    throw Error(ExitCode::finished_lossy, "the gyro's scale cannot be measured: " + turn.why_not,
                "calibrate scale",
                "turn the rig slowly by one turn and a bit more, from rest to rest; or turn it between marks "
                "with --angle 360 --marks");
  return {.gyro_scale = *turn.gyro_scale,
          .servo_scale = servo_scale(session, errors, *turn.gyro_scale),
          .turned_deg = turn.turned_deg};
}

}  // namespace thermorig::calibration

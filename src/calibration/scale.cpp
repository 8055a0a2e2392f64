// SPDX-License-Identifier: MIT
#include "rest.h"
#include "thermorig/calibration/calibration.h"
#include "thermorig/core/error.h"
#include "thermorig/labels/servo_response.h"
#include "thermorig/motion/panorama_fit.h"

namespace thermorig::calibration {

namespace {

/// The session's, with a bias that is not fooled by hands on a rig whose servo stands still.
GyroErrors errors_of(const session::Session& session) {
  GyroErrors errors = session.sync.gyro;
  if (const auto resting = resting_gyro(session.servo, session.gyro); resting && !errors.zeroes_itself)
    errors.bias_dps = Estimate{resting->bias_dps, resting->spread_dps};
  return errors;
}

std::optional<Estimate> servo_scale(const session::Session& session, GyroErrors errors,
                                    const Estimate& gyro_scale) {
  errors.scale = gyro_scale;
  errors.scale_calibrated = true;
  const ServoResponse response =
      labels::fit_servo_response(session.servo, session.gyro, errors, session.raw.header.profile.servo);
  if (!response.fitted || !response.scale_calibrated) return std::nullopt;
  return response.scale;
}

}  // namespace

ScaleResult measure_scale(const session::Session& session) {
  const CameraProfile& camera = session.raw.header.profile.camera;
  const GyroErrors errors = errors_of(session);
  const motion::TurnResult turn =
      motion::gyro_scale(session.frames, session.gyro, {camera.field_of_view_deg, camera.mirrored}, errors);
  if (!turn.gyro_scale)
    throw Error(ExitCode::finished_lossy, "no turn closes in the image: " + turn.why_not, "calibrate scale",
                "turn the rig slowly by one turn and a bit more, from rest to rest; or turn it between marks "
                "with --angle 360 --marks");
  return {.gyro_scale = *turn.gyro_scale,
          .servo_scale = servo_scale(session, errors, *turn.gyro_scale),
          .turned_deg = turn.turned_deg};
}

}  // namespace thermorig::calibration

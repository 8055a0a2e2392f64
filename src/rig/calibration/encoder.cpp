// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "thermorig/core/error.h"
#include "thermorig/fit/shaft/encoder_fit.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

EncoderResult measure_encoder(const session::Session& session) {
  const fit::EncoderFitResult found = fit::fit_encoder(session.shaft, session.gyro, session.servo,
                                                       session.sync.gyro, session.raw.header.profile.encoder);
  if (!found.fit)
    throw Error(ExitCode::finished_lossy, "the encoder's errors are not known: " + found.why_not,
                "calibrate encoder",
                session.shaft.empty() ? "connect the sensor as firmware_servo/README.md says, flash firmware "
                                        "1.3.0 or later, then thermorig calibrate encoder"
                                      : "thermorig calibrate encoder on a servo that turns by a whole turn");
  const fit::EncoderFit& fit = *found.fit;
  return {.sensor = session.raw.header.shaft_sensor,
          .encoder = fit.encoder,
          .once_deg = fit.once_deg,
          .twice_deg = fit.twice_deg,
          .turned_deg = fit.turned_deg,
          .legs = fit.legs,
          .gyro_share = fit.gyro_share,
          .noise_deg = fit.noise_deg};
}

}  // namespace thermorig::calibration

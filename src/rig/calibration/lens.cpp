// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/core/run_all.h"
#include "thermorig/estimators/odometer/lens_fit.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double worst_pitch = 0.02;  // one standard deviation: an assumption is hardly worse (0.03)
constexpr const char* lens_advice =
    "a session that turns slowly back and forth, by a whole turn where the servo can: `thermorig calibrate "
    "lens` without --session records one; point it at something with warm and cold edges, and run "
    "`thermorig calibrate orientation` first";
// What a fit is off by beyond its own spread (parallax, blur), on simulated rigs: docs/evidence/odometer.md
// shows how pitch and distortion compare with what is stated so.
constexpr double model_pitch = 0.002, model_distortion = 0.005, model_tilt_deg = 0.3, model_roll_deg = 0.2,
                 model_rows = 0.01;
// Told no better than so, a value is as good as not told.
constexpr double worst_distortion = 0.02, worst_tilt_deg = 1.5, worst_roll_deg = 1.0, worst_rows = 0.1;

std::optional<Estimate> told(const Estimate& estimate, double of_model, double worst) {
  const Estimate whole{estimate.value, std::hypot(estimate.uncertainty, of_model)};
  if (!(whole.uncertainty < worst)) return std::nullopt;
  return whole;
}

/// The session's own bias and scale: the images begin with them.
GyroProfile gyro_of(const session::Session& session) {
  GyroProfile gyro = session.raw.header.profile.gyro;
  const GyroErrors& errors = session.sync.gyro;
  if (errors.bias_dps) {
    gyro.bias_dps = errors.bias_dps->value;
    gyro.bias_uncertainty_dps = std::max(0.3, errors.bias_dps->uncertainty);
  }
  gyro.scale = errors.scale.value;
  gyro.scale_uncertainty = errors.scale.uncertainty;
  return gyro;
}

}  // namespace

bool is_not_plain(const Estimate& told) {
  return std::abs(told.value) > 2.0 * told.uncertainty;
}

LensResult measure_lens(const session::Session& session) {
  const CameraProfile& camera = session.raw.header.profile.camera;
  const odometer::LensAnswer answer =
      odometer::fit_lens(session.frames, session.gyro, gyro_of(session), camera, on_all_cores);
  const auto refuse = [](const std::string& why) {
    throw Error(ExitCode::finished_lossy, "the lens cannot be measured: " + why, "calibrate lens",
                lens_advice);
  };
  if (!answer.fit) refuse(answer.why_not);
  const odometer::LensFit& fit = *answer.fit;
  const auto pitch = told(fit.pitch_scale, model_pitch, worst_pitch);
  if (!pitch && fit.is_closed) refuse("they show too little where they overlap");
  if (!pitch)
    refuse("no whole turn closes, and the gyro's scale is not known to two per cent (calibrate scale)");
  const GyroErrors& gyro = session.sync.gyro;
  const auto gyro_delay_s = gyro.filter_source == "noise" ? std::optional(gyro.filter_delay_s) : std::nullopt;
  return {.pitch_scale = *pitch,
          .distortion = told(fit.distortion, model_distortion, worst_distortion),
          .tilt_deg = told(fit.tilt_deg, model_tilt_deg, worst_tilt_deg),
          .roll_deg = told(fit.roll_deg, model_roll_deg, worst_roll_deg),
          .row_spread = told(fit.row_spread, model_rows, worst_rows),
          .is_closed = fit.is_closed,
          .turned_deg = fit.turned_deg,
          .halves = fit.halves,
          .gyro_delay_s = gyro_delay_s};
}

}  // namespace thermorig::calibration

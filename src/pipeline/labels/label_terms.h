// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/gyro_track.h"

namespace thermorig::labels {

/// What the model of a response leaves unexplained at a speed, one standard deviation: of exposure means
/// against the gyro, or, where nothing was fitted, what servos of the kind are known for.
double model_deviation_dps(const ServoResponse& response, double rate_dps);

/// Noise of a gyro sample while the shaft turns at that speed: as at rest, or more where gears are heard.
/// `so_far_dps`: what was heard of them, where no response was fitted.
double gyro_noise_dps(const GyroErrors& errors, const ServoResponse& response, double rate_dps,
                      double so_far_dps);

/// What the shaft makes of a commanded speed: times `gain`, that of the travel that the shaft passed
/// meanwhile (scale in it), plus what the gyro saw beyond the model over this session's legs of that speed.
/// Where nothing was fitted, what was commanded.
double corrected_dps(const ServoResponse& response, double commanded_dps, double gain);

/// How far a label may be from the shaft's true speed over an exposure, one standard deviation: its distance
/// from the model, which follows the shaft from frame to frame, and what is uncertain of that. What the gyro
/// saw beyond the model at the commanded speed is added to the model first. `time_dps` for the time of the
/// exposure. NaN without a model (`shaft_dps`).
double label_deviation_dps(const ServoResponse& response, double commanded_dps, double label_dps,
                           double shaft_dps, double time_dps);

/// The gyro's mean, corrected, minus the shaft's speed as the gyro would see it, in units of its standard
/// deviation: bias, noise (of a sample, `noise_dps`), the model's residual, `time_dps` for the time between
/// gyro and model, and the scale between both. `bias_dps`: at that time. 0 where nothing can be said.
double gyro_z_score(const GyroErrors& errors, const ServoResponse& response, const GyroMean& gyro,
                    double noise_dps, double bias_dps, double shaft_dps, double time_dps);

/// Whether gyro_spread is wider than `tolerance_dps`, beyond what such noise of a sample, and chance,
/// explain.
bool is_unsteady(const GyroMean& gyro, double noise_dps, double tolerance_dps);

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "thermorig/labels/servo_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::labels {

namespace {
constexpr double gyro_scale_uncertainty = 0.03;
constexpr double loop_doubt = 0.3;  // relative, of a bandwidth that nobody measured
constexpr double delay_doubt_s = 0.01;
constexpr double phase_lag = 1.4;  // a loop of damping 0.7 lags by 2 * 0.7 / (2 pi bandwidth)
constexpr double least_loop_hz = 0.5;
}  // namespace

ServoResponse assumed_response(const ServoProfile& profile) {
  ServoResponse response;
  response.loop_hz = std::max(profile.loop_hz, least_loop_hz);
  const double lag_s = phase_lag / (2.0 * std::numbers::pi * response.loop_hz);
  response.delay_uncertainty_s = std::hypot(delay_doubt_s, loop_doubt * lag_s);
  response.scale = {profile.scale, profile.scale_uncertainty};
  response.scale_calibrated = !profile.scale_measured_utc.empty();
  response.gyro_ratio = {profile.scale, std::hypot(profile.scale_uncertainty, gyro_scale_uncertainty)};
  return response;
}

ServoResponse fit_servo_response(std::span<const TimedServo>, std::span<const TimedGyro>, const GyroErrors&,
                                 const ServoProfile& profile) {
  return assumed_response(profile);
}

GyroErrors fit_gyro_errors(std::span<const TimedGyro>, std::span<const TimedServo>,
                           const GyroProfile& profile) {
  GyroErrors errors;
  errors.scale = {profile.scale, profile.scale_uncertainty};
  errors.scale_calibrated = !profile.scale_measured_utc.empty();
  return errors;
}

}  // namespace thermorig::labels

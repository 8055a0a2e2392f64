// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/servo_loop.h"

#include <numbers>

#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

namespace {
constexpr double damping = 0.7;
constexpr double half_stair_s = 0.01;            // a command in steps of 20 ms lies so far behind its ramp
constexpr double to_one_percent = 4.605;         // -ln(0.01)
constexpr double gyro_scale_uncertainty = 0.03;  // as data sheets promise it
constexpr double loop_doubt = 0.3;               // relative, of a bandwidth that nobody measured
constexpr double delay_doubt_s = 0.01;
constexpr double phase_lag = 1.4;  // a loop of damping 0.7 lags by 2 * 0.7 / (2 pi bandwidth)
}  // namespace

ServoLoop::ServoLoop(bool continuous, double loop_hz, double dead_band_deg)
    : continuous_(continuous),
      loop_rad_(2.0 * std::numbers::pi * std::max(loop_hz, 0.01)),
      half_dead_band_deg_(dead_band_deg / 2.0) {}

void ServoLoop::restart(double value, double rate_dps) {
  if (continuous_) {
    rate_dps_ = value;
    return;
  }
  const double lag_s = 2.0 * damping / loop_rad_ + half_stair_s;
  angle_deg_ = value - rate_dps * lag_s;
  rate_dps_ = rate_dps;
}

/// The free motion of x'' = -2 d w x' - w^2 x over a step, x the angle's offset from the command; of a
/// continuous servo x' = -w x, x the rate's.
void ServoLoop::set_step(double step_s) {
  if (step_s == step_s_) return;
  step_s_ = step_s;
  if (continuous_) {
    rate_from_rate_ = std::exp(-loop_rad_ * step_s);
    return;
  }
  const double decay_rad = damping * loop_rad_;
  const double swing_rad = loop_rad_ * std::sqrt(1.0 - damping * damping);
  const double left = std::exp(-decay_rad * step_s);
  const double cosine = left * std::cos(swing_rad * step_s);
  const double sine = left * std::sin(swing_rad * step_s) / swing_rad;
  from_angle_ = cosine + decay_rad * sine;
  from_rate_ = sine;
  rate_from_angle_ = -loop_rad_ * loop_rad_ * sine;
  rate_from_rate_ = cosine - decay_rad * sine;
}

void ServoLoop::take_step(double value) {
  if (continuous_) {
    const double off_dps = rate_dps_ - value;
    rate_dps_ = value + off_dps * rate_from_rate_;
    angle_deg_ += value * step_s_ + off_dps * (1.0 - rate_from_rate_) / loop_rad_;
    return;
  }
  const double error_deg = value - angle_deg_;
  const double goal_deg = value - std::clamp(error_deg, -half_dead_band_deg_, half_dead_band_deg_);
  const double off_deg = angle_deg_ - goal_deg;
  angle_deg_ = goal_deg + from_angle_ * off_deg + from_rate_ * rate_dps_;
  rate_dps_ = rate_from_angle_ * off_deg + rate_from_rate_ * rate_dps_;
}

/// A first-order lag is taken with the damping too, on the safe side.
double settle_s(const ServoResponse& response) {
  const double loop_rad = 2.0 * std::numbers::pi * std::max(response.loop_hz, least_loop_hz);
  return std::max(response.delay_s, 0.0) + pulse_period_s + to_one_percent / (damping * loop_rad);
}

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

}  // namespace thermorig::labels

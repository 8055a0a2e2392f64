// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/servo_model.h"

#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>

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

ShaftSlope::ShaftSlope(std::vector<double> gain, std::vector<ServoResponse::Ripple> ripples,
                       const PulseScale& scale)
    : scale_(scale), gain_(std::move(gain)), ripples_(std::move(ripples)) {
  if (gain_.empty()) gain_ = {1.0, 1.0};
  if (gain_.size() == 1) gain_.push_back(gain_.front());
  is_even_ = std::adjacent_find(gain_.begin(), gain_.end(), std::not_equal_to<>()) == gain_.end();
  turned_ = {0.0};
  for (std::size_t i = 0; i + 1 < gain_.size(); ++i)
    turned_.push_back(turned_.back() + (gain_[i] + gain_[i + 1]) / 2.0);
  middle_ = knots_turned(place(0.0));
}

/// Between the knots, and beyond them by as much.
double ShaftSlope::place(double value) const {
  return (scale_.part(value) + 1.0) / 2.0 * static_cast<double>(gain_.size() - 1);
}

double ShaftSlope::gain(double value) const {
  if (is_even_) return gain_.front();
  const double last = static_cast<double>(gain_.size() - 1);
  // fmin and fmax: a value that is not a number has a place as well.
  const double within = std::fmax(0.0, std::fmin(place(value), last));
  const std::size_t left = std::min(static_cast<std::size_t>(within), gain_.size() - 2);
  return std::lerp(gain_[left], gain_[left + 1], within - static_cast<double>(left));
}

double ShaftSlope::knots_turned(double place) const {
  const double last = static_cast<double>(gain_.size() - 1);
  const double within = std::fmax(0.0, std::fmin(place, last));
  const std::size_t left = std::min(static_cast<std::size_t>(within), gain_.size() - 2);
  const double share = within - static_cast<double>(left);
  const double beyond = place < 0.0    ? place * gain_.front()
                        : place > last ? (place - last) * gain_.back()
                                       : 0.0;
  return turned_[left] + share * (gain_[left] + share * (gain_[left + 1] - gain_[left]) / 2.0) + beyond;
}

double ShaftSlope::gained_deg(double angle_deg) const {
  const double knot_deg = 1.0 / (place(1.0) - place(0.0));
  return knot_deg * (knots_turned(place(angle_deg)) - middle_);
}

double ShaftSlope::at(double angle_deg, bool forward) const {
  double share = 1.0;
  if (!ripples_.empty()) {
    const double gained = gained_deg(angle_deg);
    for (const ServoResponse::Ripple& ripple : ripples_) {
      const double phase = 2.0 * std::numbers::pi * gained / ripple.period_deg;
      const double cosine = forward ? ripple.forward_cosine : ripple.backward_cosine;
      const double sine = forward ? ripple.forward_sine : ripple.backward_sine;
      share += cosine * std::cos(phase) + sine * std::sin(phase);
    }
  }
  return share * gain(angle_deg);
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

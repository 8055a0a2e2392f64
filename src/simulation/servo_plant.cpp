// SPDX-License-Identifier: MIT
#include "servo_plant.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shaft.h"

namespace thermorig::simulation {
namespace {

constexpr double step_s = static_cast<double>(Shaft::step_ns) * 1e-9;
constexpr double damping = 0.7;
constexpr std::int64_t signal_lost_ns = 60'000'000;  // three missing pulses
constexpr double scale_error = 0.01;                 // standard deviation over runs
constexpr double slope_error = 0.005;                // standard deviation along the travel
constexpr double friction_time_s = 0.02;             // an unpowered gear stops at once
constexpr double coast_time_s = 0.15;                // a continuous servo's motor runs down

double without_dead_band(double error, double dead_band) {
  return std::copysign(std::max(0.0, std::abs(error) - dead_band / 2.0), error);
}

}  // namespace

ServoPlant::ServoPlant(const ServoProfile& servo, double loop_hz, std::uint64_t seed) : servo_(servo) {
  Random random(seed, "servo");
  loop_rad_ = 2.0 * std::numbers::pi * loop_hz;
  max_rate_dps_ = random.uniform(375.0, 600.0);
  max_acceleration_dps2_ = 2000.0 * loop_hz;  // a stiff loop needs a strong motor
  dead_band_deg_ = random.uniform(0.2, 0.5);
  dead_band_us_ = random.uniform(2.0, 5.0);
  scale_ = 1.0 + random.normal(scale_error);
  for (Wave& wave : waves_)
    wave = {random.normal(slope_error * std::sqrt(2.0 / 3.0)), random.uniform(0.0, 2.0 * std::numbers::pi)};
  angle_deg_ = random.normal(5.0);
  target_ = servo.kind == ServoKind::positional ? angle_deg_ : 0.0;
}

void ServoPlant::pulse(std::int64_t end_ns, double width_us) {
  coming_.push_back({end_ns, width_us});
}

/// The ideal angle with a slope that is a little wrong, differently along the travel.
double ServoPlant::target_angle_deg(double width_us) const {
  const double half_width_us = (servo_.pulse_max_us - servo_.pulse_min_us) / 2.0;
  const double middle_us = servo_.pulse_min_us + half_width_us;
  const double part = std::clamp((width_us - middle_us) / half_width_us, -1.05, 1.05);  // of half the travel
  double angle_deg = scale_ * part * servo_.travel_deg / 2.0;
  for (std::size_t n = 0; n < waves_.size(); ++n) {
    const double cycles_rad = std::numbers::pi * static_cast<double>(n + 1);
    angle_deg += waves_[n].amplitude * servo_.travel_deg / 2.0 / cycles_rad *
                 std::sin(cycles_rad * part + waves_[n].phase_rad);
  }
  return angle_deg;
}

double ServoPlant::target_rate_dps(double width_us) const {
  const double half_width_us = (servo_.pulse_max_us - servo_.pulse_min_us) / 2.0;
  const double off_us = width_us - (servo_.pulse_min_us + half_width_us);
  if (std::abs(off_us) < dead_band_us_) return 0.0;
  const double part = std::clamp(off_us / half_width_us, -1.05, 1.05);
  double scale = scale_;
  for (std::size_t n = 0; n < waves_.size(); ++n)
    scale += waves_[n].amplitude *
             std::sin(std::numbers::pi * static_cast<double>(n + 1) * part + waves_[n].phase_rad);
  return scale * part * servo_.full_rate_dps;
}

double ServoPlant::positional_acceleration_dps2(bool driven) {
  if (!driven) return -rate_dps_ / friction_time_s;
  const double error_deg = without_dead_band(target_ - angle_deg_, dead_band_deg_);
  return loop_rad_ * loop_rad_ * error_deg - 2.0 * damping * loop_rad_ * rate_dps_;
}

double ServoPlant::continuous_acceleration_dps2(bool driven) const {
  return driven ? loop_rad_ * (target_ - rate_dps_) : -rate_dps_ / coast_time_s;
}

void ServoPlant::step(std::int64_t begin_ns) {
  const bool positional = servo_.kind == ServoKind::positional;
  for (; !coming_.empty() && coming_.front().end_ns <= begin_ns; coming_.pop_front()) {
    last_ = coming_.front();
    target_ = positional ? target_angle_deg(last_.width_us) : target_rate_dps(last_.width_us);
  }
  const bool driven = begin_ns - last_.end_ns < signal_lost_ns;
  const double wanted_dps2 =
      positional ? positional_acceleration_dps2(driven) : continuous_acceleration_dps2(driven);
  const double before_dps = rate_dps_;
  rate_dps_ += step_s * std::clamp(wanted_dps2, -max_acceleration_dps2_, max_acceleration_dps2_);
  rate_dps_ = std::clamp(rate_dps_, -max_rate_dps_, max_rate_dps_);
  angle_deg_ += step_s * (before_dps + rate_dps_) / 2.0;
}

}  // namespace thermorig::simulation

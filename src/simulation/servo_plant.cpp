// SPDX-License-Identifier: MIT
#include "servo_plant.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shaft.h"

namespace thermorig::simulation {
namespace {

constexpr double step_s = static_cast<double>(Shaft::step_ns) * 1e-9;
constexpr std::int64_t signal_lost_ns = 60'000'000;  // three missing pulses
constexpr double scale_error = 0.01;                 // standard deviation over runs
constexpr double slope_error = 0.005;                // standard deviation along the travel
constexpr double friction_time_s = 0.02;             // an unpowered gear stops at once
constexpr double coast_time_s = 0.15;                // a continuous servo's motor runs down
constexpr double grease_time_s = 120.0;              // in which friction warms up

double without_dead_band(double error, double dead_band) {
  return std::copysign(std::max(0.0, std::abs(error) - dead_band / 2.0), error);
}

}  // namespace

ServoPlant::ServoPlant(const ServoProfile& servo, double loop_hz, std::uint64_t seed, const ServoWorld& world)
    : servo_(servo),
      world_(world),
      train_(world, seed, 0.0),
      friction_(world.stick_deg),
      supply_(world.supply_sag, world.top_speed_dps) {
  Random random(seed, "servo");
  loop_rad_ = 2.0 * std::numbers::pi * loop_hz;
  supply_ = Supply(world.supply_sag, std::min(random.uniform(375.0, 600.0), world.top_speed_dps));
  max_acceleration_dps2_ = 2000.0 * loop_hz;  // a stiff loop needs a strong motor
  dead_band_deg_ = random.uniform(0.2, 0.5) + world.dead_band_deg;
  dead_band_us_ = random.uniform(2.0, 5.0);
  scale_ = 1.0 + random.normal(scale_error);
  for (Wave& wave : waves_)
    wave = {random.normal(slope_error * std::sqrt(2.0 / 3.0)), random.uniform(0.0, 2.0 * std::numbers::pi)};
  angle_deg_ = random.normal(5.0);
  target_ = servo.kind == ServoKind::positional ? angle_deg_ : 0.0;
  train_ = GearTrain(world, seed, angle_deg_);
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

/// What the loop sees: a load pushes the shaft away.
double ServoPlant::loop_error_deg() const {
  double error_deg = target_ - angle_deg_;
  if (world_.load_deg > 0.0) error_deg -= world_.load_deg * std::sin(angle_deg_ * std::numbers::pi / 180.0);
  return without_dead_band(error_deg, dead_band_deg_);
}

double ServoPlant::positional_acceleration_dps2(bool driven) {
  const double error_deg = loop_error_deg();
  if (!driven || friction_.holds(error_deg)) return -rate_dps_ / friction_time_s;
  return loop_rad_ * loop_rad_ * error_deg - 2.0 * world_.damping * loop_rad_ * rate_dps_;
}

double ServoPlant::continuous_acceleration_dps2(bool driven) const {
  return driven ? loop_rad_ * (target_ - rate_dps_) : -rate_dps_ / coast_time_s;
}

void ServoPlant::turn_gear(double wanted_dps2) {
  const double before_dps = rate_dps_;
  const double ceiling_dps = supply_.ceiling_dps(rate_dps_, step_s);
  rate_dps_ += step_s * std::clamp(wanted_dps2, -max_acceleration_dps2_, max_acceleration_dps2_);
  rate_dps_ = std::clamp(rate_dps_, -ceiling_dps, ceiling_dps);
  angle_deg_ += step_s * (before_dps + rate_dps_) / 2.0;
}

/// Cold grease takes as much force as the loop has for an error of `friction_deg`.
void ServoPlant::turn_gear_against_friction(double wanted_dps2, double friction_deg) {
  const double friction_dps2 = loop_rad_ * loop_rad_ * friction_deg;
  const double before_dps = rate_dps_;
  if (before_dps == 0.0 && std::abs(wanted_dps2) <= friction_dps2) return;
  turn_gear(wanted_dps2 - std::copysign(friction_dps2, before_dps != 0.0 ? before_dps : wanted_dps2));
  if (rate_dps_ * before_dps < 0.0) rate_dps_ = 0.0;  // it has stopped in between
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
  if (positional && world_.cold_friction_deg > 0.0)
    turn_gear_against_friction(
        wanted_dps2,
        world_.cold_friction_deg * std::exp(-1e-9 * static_cast<double>(begin_ns) / grease_time_s));
  else
    turn_gear(wanted_dps2);
  const double before_deg = train_.shaft_deg();
  train_.follow(angle_deg_);
  const bool is_rigid = world_.backlash_deg == 0.0 && world_.ripple == 0.0;
  shaft_dps_ = is_rigid ? rate_dps_ : (train_.shaft_deg() - before_deg) / step_s;
}

}  // namespace thermorig::simulation

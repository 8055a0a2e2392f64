// SPDX-License-Identifier: MIT
#include "position_servo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.h"

namespace thermorig::simulation {
namespace {

constexpr double own_loop_hz = 12.0;  // it feeds the profile's speed forward
constexpr double brake_time_s = 0.01;
constexpr double sticks_below_dps = 25.0;
constexpr double supply_time_s = 2.0;  // in which a weak supply gives way

}  // namespace

GearTrain::GearTrain(const ServoWorld& world, std::uint64_t seed, double gear_deg)
    : play_deg_(world.backlash_deg / 2.0),
      ripple_(world.ripple),
      wheel_rad_(2.0 * std::numbers::pi / world.ripple_period_deg),  // a degree of the gear
      ripple_phase_rad_(Random(seed, "servo ripple").uniform(0.0, 2.0 * std::numbers::pi)),
      pushed_deg_(gear_deg),
      shaft_deg_(gear_deg) {
  follow(gear_deg);
}

double GearTrain::follow(double gear_deg) {
  pushed_deg_ = std::clamp(pushed_deg_, gear_deg - play_deg_, gear_deg + play_deg_);
  shaft_deg_ = pushed_deg_;
  if (ripple_ > 0.0)
    shaft_deg_ += ripple_ / wheel_rad_ * std::sin(wheel_rad_ * pushed_deg_ + ripple_phase_rad_);
  return shaft_deg_;
}

bool Friction::holds(double error_deg) {
  stuck_ = std::abs(error_deg) < (stuck_ ? stick_deg_ : stick_deg_ / 2.0);
  return stuck_;
}

double Supply::ceiling_dps(double rate_dps, double dt_s) {
  if (sag_ == 0.0) return top_dps_;
  const double ceiling_dps = top_dps_ * (1.0 - sag_ * strain_);
  strain_ += dt_s / supply_time_s * (std::min(1.0, std::abs(rate_dps) / ceiling_dps) - strain_);
  return ceiling_dps;
}

PositionServo::PositionServo(const ServoWorld& world, std::uint64_t seed, double angle_deg, double top_dps)
    : load_deg_(world.load_deg),
      train_(world, seed, angle_deg),
      friction_(world.stick_deg),
      supply_(world.supply_sag, std::min(top_dps, world.top_speed_dps)),
      profile_deg_(train_.shaft_deg()),
      gear_deg_(angle_deg) {}

void PositionServo::coast(double dt_s) {
  profile_dps_ = 0.0;
  gear_dps_ -= gear_dps_ * std::min(1.0, dt_s / brake_time_s);
  move(dt_s);
  begin_here();
}

void PositionServo::turn(const Profile& profile, double dt_s) {
  follow(profile, dt_s);
  double error_deg = profile_deg_ - shaft_deg();
  if (load_deg_ > 0.0) error_deg -= load_deg_ * std::sin(shaft_deg() * std::numbers::pi / 180.0);
  const double rad = 2.0 * std::numbers::pi * own_loop_hz;
  const double wanted_dps2 = rad * rad * error_deg + 2.0 * rad * (profile_dps_ - gear_dps_);
  // Faster than that it does not stick, however little its loop asks for.
  if (std::abs(gear_dps_) < sticks_below_dps && friction_.holds(wanted_dps2 / (rad * rad)))
    gear_dps_ -= gear_dps_ * std::min(1.0, dt_s / brake_time_s);
  else
    gear_dps_ += wanted_dps2 * dt_s;
  const double ceiling_dps = supply_.ceiling_dps(gear_dps_, dt_s);
  gear_dps_ = std::clamp(gear_dps_, -ceiling_dps, ceiling_dps);
  move(dt_s);
}

void PositionServo::move(double dt_s) {
  const double before_deg = shaft_deg();
  gear_deg_ += gear_dps_ * dt_s;
  shaft_dps_ = (train_.follow(gear_deg_) - before_deg) / dt_s;
}

/// A speed that can still be brought to rest at the goal.
void PositionServo::follow(const Profile& profile, double dt_s) {
  const double change_dps = profile.acceleration_dps2 * dt_s;
  double wanted_dps = 0.0;
  if (profile.goal_deg) {
    const double way_deg = *profile.goal_deg - profile_deg_;
    const double fits_dps = std::sqrt(2.0 * profile.acceleration_dps2 * std::abs(way_deg));
    wanted_dps = std::copysign(std::min(profile.most_dps, fits_dps), way_deg);
    if (std::abs(way_deg) <= change_dps * dt_s && std::abs(profile_dps_) <= 2.0 * change_dps) {
      profile_deg_ += way_deg;
      profile_dps_ = 0.0;
      return;
    }
  }
  profile_dps_ += std::clamp(wanted_dps - profile_dps_, -change_dps, change_dps);
  profile_deg_ += profile_dps_ * dt_s;
}

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "position_servo.h"
#include "random.h"
#include "thermorig/core/profile.h"
#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

/// The servo itself: pulses in, shaft out. Its own position loop (second order) follows the pulse width, with
/// a top speed, an acceleration limit, a dead band and an imperfect sense of angle. A continuous servo
/// follows the pulse with its speed; friction and load are those of positional ones. Without pulses a
/// positional servo stays where it is, a continuous one coasts to rest. The loop knows the gear's angle;
/// behind it comes the shaft.
class ServoPlant {
 public:
  ServoPlant(const ServoProfile& servo, double loop_hz, std::uint64_t seed, const ServoWorld& world = {});

  /// A pulse ended at rig time `end_ns`; pulses come in order.
  void pulse(std::int64_t end_ns, double width_us);

  /// One step of Shaft::step_ns that begins at rig time `begin_ns`.
  void step(std::int64_t begin_ns);

  // Of the shaft.
  double angle_deg() const { return train_.shaft_deg(); }
  double rate_dps() const { return shaft_dps_; }

 private:
  struct Pulse {
    std::int64_t end_ns;
    double width_us;
  };
  double target_angle_deg(double width_us) const;
  double target_rate_dps(double width_us) const;
  double positional_acceleration_dps2(bool driven);
  double continuous_acceleration_dps2(bool driven) const;
  double loop_error_deg() const;
  void turn_gear(double wanted_dps2);
  void turn_gear_against_friction(double wanted_dps2, double friction_deg);

  ServoProfile servo_;
  ServoWorld world_;
  double loop_rad_;  // natural frequency, rad/s
  double max_acceleration_dps2_;
  double dead_band_deg_;
  double scale_;  // of the whole run
  double dead_band_us_;
  struct Wave {
    double amplitude;  // of the slope, relative
    double phase_rad;
  };
  std::array<Wave, 3> waves_{};  // slope errors along the travel (positional) or the speed range (continuous)
  std::deque<Pulse> coming_;
  Pulse last_{-1'000'000'000, 0.0};
  double target_ = 0.0;  // deg or deg/s, by kind
  double angle_deg_;     // of the gear
  double rate_dps_ = 0.0;
  GearTrain train_;
  Friction friction_;
  Supply supply_;
  double shaft_dps_ = 0.0;
};

}  // namespace thermorig::simulation

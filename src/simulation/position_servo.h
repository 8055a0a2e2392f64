// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

/// What is between a gear and the shaft: the shaft is pushed by whichever flank touches it, and by a wheel
/// off its centre.
class GearTrain {
 public:
  GearTrain(const ServoWorld& world, std::uint64_t seed, double gear_deg);

  /// Where the shaft is once the gear has turned to `gear_deg`.
  double follow(double gear_deg);
  double shaft_deg() const { return shaft_deg_; }

 private:
  double play_deg_, ripple_, wheel_rad_;
  double ripple_phase_rad_;
  double pushed_deg_;  // where the gear has pushed what it drives
  double shaft_deg_;
};

/// Friction stops a servo where half of stick_deg is left of its error, and holds it until there is all.
class Friction {
 public:
  explicit Friction(double stick_deg) : stick_deg_(stick_deg) {}
  bool holds(double error_deg);

 private:
  double stick_deg_;
  bool stuck_ = false;
};

/// A weak supply gives way while the servo turns at the speed that is left.
class Supply {
 public:
  Supply(double sag, double top_dps) : sag_(sag), top_dps_(top_dps) {}
  /// The fastest, after a step at this speed.
  double ceiling_dps(double rate_dps, double dt_s);

 private:
  double sag_, top_dps_;
  double strain_ = 0.0;  // 0 to 1
};

/// A servo that turns to a goal by a trapezium of speed of its own, which its position loop follows by the
/// sensor on its shaft.
class PositionServo {
 public:
  PositionServo(const ServoWorld& world, std::uint64_t seed, double angle_deg, double top_dps);

  struct Profile {
    std::optional<double> goal_deg;  // none: it brakes
    double most_dps = 0.0;
    double acceleration_dps2 = 0.0;
  };
  void turn(const Profile& profile, double dt_s);
  /// Without torque: the gear stops it.
  void coast(double dt_s);
  /// Torque is switched on: its profile begins where the shaft is.
  void begin_here() { profile_deg_ = shaft_deg(); }

  double shaft_deg() const { return train_.shaft_deg(); }
  double shaft_dps() const { return shaft_dps_; }
  double profile_deg() const { return profile_deg_; }
  double profile_dps() const { return profile_dps_; }

 private:
  void follow(const Profile& profile, double dt_s);
  void move(double dt_s);

  double load_deg_;
  GearTrain train_;
  Friction friction_;
  Supply supply_;
  double profile_deg_, profile_dps_ = 0.0;
  double gear_deg_, gear_dps_ = 0.0;
  double shaft_dps_ = 0.0;
};

}  // namespace thermorig::simulation

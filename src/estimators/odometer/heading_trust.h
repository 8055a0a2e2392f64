// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "tracker.h"

namespace thermorig::odometer {

/// Whether a heading is believed. One that a search found must prove itself first; where the gyro says
/// something else and was there all the time, one of the two is wrong, and as long as the rig keeps its speed
/// nobody can tell which.
class HeadingTrust {
 public:
  HeadingTrust() = default;

  /// Of a heading that nothing speaks against.
  void begin(double rate_dps) { *this = {0, false, rate_dps}; }
  /// Of one that a search found, or that the gyro alone has carried here.
  void begin_unproven(double rate_dps, bool gyro_differs) {
    *this = {gyro_differs ? halves_to_trust_doubted : halves_to_trust, gyro_differs, rate_dps};
  }
  /// Of one in a map of before: only halves at another speed tell. For a slow rig a rest is one.
  void begin_in_map(double rate_dps) {
    begin_unproven(rate_dps, true);
    change_dps_ = std::clamp(0.75 * std::abs(rate_dps), least_change_dps, telling_change_dps);
  }
  /// It leans to one side where things move.
  void doubt_lean() { halves_left_ = halves_to_trust_doubted; }

  /// Of a half that was judged.
  void add(const HalfResult& result) {
    slowest_dps_ = std::min(slowest_dps_, result.rate_dps);
    fastest_dps_ = std::max(fastest_dps_, result.rate_dps);
    if (gyro_differs_ && std::abs(result.rate_dps - begun_dps_) < change_dps_) return;
    if (result.is_used) halves_left_ = std::max(0, halves_left_ - 1);
    if (halves_left_ == 0) gyro_differs_ = false;
  }

  bool is_trusted() const { return halves_left_ == 0; }
  /// So much that a wrong time would have shown.
  bool has_changed_speed() const { return fastest_dps_ - slowest_dps_ >= telling_change_dps; }

 private:
  static constexpr int halves_to_trust = 8, halves_to_trust_doubted = 16;
  static constexpr double telling_change_dps = 40.0, least_change_dps = 10.0;

  HeadingTrust(int halves, bool gyro_differs, double rate_dps)
      : halves_left_(halves),
        gyro_differs_(gyro_differs),
        begun_dps_(rate_dps),
        slowest_dps_(rate_dps),
        fastest_dps_(rate_dps) {}

  int halves_left_ = 0;
  bool gyro_differs_ = false;
  double begun_dps_ = 0.0;                        // the speed at which it was found
  double change_dps_ = telling_change_dps;        // what another speed is
  double slowest_dps_ = 0.0, fastest_dps_ = 0.0;  // since it began
};

}  // namespace thermorig::odometer

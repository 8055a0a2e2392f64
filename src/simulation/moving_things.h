// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

/// What moves or changes in front of the panorama: people, pets, sun.
class MovingThings {
 public:
  MovingThings(const SceneWorld& world, std::uint64_t seed);

  bool are_there() const { return !things_.empty(); }

  /// They go to where they are then.
  void move_to(double time_s);

  /// What is seen in a direction in which the panorama has `behind_c`.
  float seen_c(double azimuth_deg, double elevation_deg, float behind_c) const;

 private:
  struct Thing {
    double width_deg = 0.0, low_deg = 0.0, high_deg = 0.0;
    double speed_dps = 0.0;
    double reach_deg = 0.0;         // to each side of its middle; 0: always onward
    bool adds = false;              // to what is behind it, instead of hiding it
    double temp_c = 0.0;            // or what it adds, K
    double flicker_period_s = 0.0;  // it comes and goes; 0: it stays
    double middle_deg = 0.0, phase = 0.0;
    double azimuth_deg = 0.0;  // now
    double strength = 1.0;     // now, 0 to 1
  };
  void add(Thing thing, std::uint64_t seed, const char* stream);

  std::vector<Thing> things_;
};

}  // namespace thermorig::simulation

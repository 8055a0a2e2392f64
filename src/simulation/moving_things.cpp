// SPDX-License-Identifier: MIT
#include "moving_things.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.h"

namespace thermorig::simulation {
namespace {

constexpr double edge_deg = 2.0;                // a pixel's response makes edges soft
constexpr double sun_wander_dps = 15.0 / 3600;  // the Earth's turn
constexpr double cloud_period_s = 90.0;

/// 1 inside of +-`half_deg`, 0 outside.
double inside(double off_deg, double half_deg) {
  return std::clamp((half_deg - std::abs(off_deg)) / edge_deg + 0.5, 0.0, 1.0);
}

/// From -1 to 1 and back, `walked` measured in ways from the middle to an end.
double to_and_fro(double walked) {
  const double part = walked - 4.0 * std::floor(walked / 4.0);
  return part < 1.0 ? part : part < 3.0 ? 2.0 - part : part - 4.0;
}

}  // namespace

MovingThings::MovingThings(const SceneWorld& world, std::uint64_t seed) {
  if (world.person_dps > 0.0)
    add({.width_deg = 9.0,
         .low_deg = -45.0,
         .high_deg = 14.0,
         .speed_dps = world.person_dps,
         .reach_deg = 40.0,
         .temp_c = 30.0},
        seed, "person");
  if (world.pet_dps > 0.0)
    add({.width_deg = 8.0,
         .low_deg = -16.0,
         .high_deg = -9.0,
         .speed_dps = world.pet_dps,
         .reach_deg = 25.0,
         .temp_c = 28.0},
        seed, "pet");
  if (world.sun_k > 0.0)
    add({.width_deg = 14.0,
         .low_deg = -12.0,
         .high_deg = 4.0,
         .speed_dps = sun_wander_dps,
         .adds = true,
         .temp_c = world.sun_k,
         .flicker_period_s = cloud_period_s},
        seed, "sun");
}

void MovingThings::add(Thing thing, std::uint64_t seed, const char* stream) {
  Random random(seed, stream);
  thing.middle_deg = random.uniform(0.0, 360.0);
  thing.phase = random.uniform();
  things_.push_back(thing);
}

void MovingThings::move_to(double time_s) {
  for (Thing& thing : things_) {
    const double way_deg = thing.speed_dps * time_s;
    thing.azimuth_deg =
        thing.middle_deg + (thing.reach_deg > 0.0
                                ? thing.reach_deg * to_and_fro(way_deg / thing.reach_deg + 4.0 * thing.phase)
                                : way_deg);
    if (thing.flicker_period_s > 0.0)
      thing.strength =
          0.5 + 0.5 * std::sin(2.0 * std::numbers::pi * (time_s / thing.flicker_period_s + thing.phase));
  }
}

float MovingThings::seen_c(double azimuth_deg, double elevation_deg, float behind_c) const {
  double temp_c = behind_c;
  for (const Thing& thing : things_) {
    const double off_deg = std::remainder(azimuth_deg - thing.azimuth_deg, 360.0);
    const double weight = thing.strength * inside(off_deg, thing.width_deg / 2.0) *
                          inside(elevation_deg - (thing.low_deg + thing.high_deg) / 2.0,
                                 (thing.high_deg - thing.low_deg) / 2.0);
    temp_c += weight * (thing.adds ? thing.temp_c : thing.temp_c - temp_c);
  }
  return static_cast<float>(temp_c);
}

}  // namespace thermorig::simulation

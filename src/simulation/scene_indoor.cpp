// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <numbers>

#include "scene_shapes.h"
#include "scenes.h"

namespace thermorig::simulation {
namespace {

constexpr double to_rad = std::numbers::pi / 180.0;

/// Walls: a base temperature, warmer toward the ceiling, with slow changes around the room.
Panorama bare_room(Random& random) {
  Panorama room;
  const double base_c = random.uniform(21.5, 24.5);
  std::array<double, 6> phases{};
  for (double& phase : phases) phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  for (int azimuth = 0; azimuth < Panorama::azimuths; ++azimuth) {
    double wall_c = base_c;
    for (int n = 1; n <= 6; ++n)
      wall_c +=
          0.35 / n * std::cos(n * azimuth * Panorama::azimuth_step_deg * to_rad + phases[std::size_t(n - 1)]);
    for (int row = 0; row < Panorama::elevations; ++row)
      room.at(row, azimuth) = static_cast<float>(wall_c + 0.035 * elevation_deg(row));
  }
  return room;
}

void add_texture(Panorama& room, Random& random, double amplitude_k) {
  const auto texture = fractal_texture(random);
  for (std::size_t i = 0; i < texture.size(); ++i)
    room.temp_c[i] += static_cast<float>(amplitude_k) * texture[i];
}

void add_corners(Panorama& room, Random& random) {
  const double first_deg = random.uniform(0.0, 90.0);
  for (int corner = 0; corner < 4; ++corner) {
    const double change_k = -random.uniform(0.2, 0.6);
    add_to_patch(room, {first_deg + 90.0 * corner + random.normal(8.0), 2.0, -45.0, 45.0}, change_k);
  }
}

void add_openings(Panorama& room, Random& random) {
  const double season = random.sign();  // windows are all warm or all cold
  for (int n = random.integer(1, 3); n > 0; --n) {
    const double change_k = season * random.uniform(1.5, 5.0);
    add_to_patch(room, {any_azimuth(random), random.uniform(10.0, 28.0), -6.0, random.uniform(14.0, 26.0)},
                 change_k);
  }
  for (int n = random.integer(1, 2); n > 0; --n) {
    const double change_k = random.normal(0.6);
    add_to_patch(room, {any_azimuth(random), random.uniform(9.0, 16.0), -45.0, 14.0}, change_k);
  }
}

void add_ceiling(Panorama& room, Random& random) {
  for (int n = random.integer(2, 5); n > 0; --n) {
    const double low_deg = random.uniform(16.0, 32.0);
    const double change_k = random.uniform(2.0, 9.0);
    add_to_patch(room, {any_azimuth(random), random.uniform(4.0, 14.0), low_deg, low_deg + 2.0}, change_k);
  }
  for (int n = random.integer(0, 2); n > 0; --n) {
    const double change_k = -random.uniform(2.0, 6.0);
    add_spot(room, {any_azimuth(random), 6.0, 18.0, 22.0}, change_k);
  }
}

void add_furniture(Panorama& room, Random& random, int fewest, int most) {
  for (int n = random.integer(fewest, most); n > 0; --n) {
    const double low_deg = random.uniform(-30.0, -4.0);
    const double height_deg = random.uniform(3.0, 14.0);
    const double change_k = random.normal(0.8);
    add_spot(room, {any_azimuth(random), random.uniform(3.0, 16.0), low_deg, low_deg + height_deg}, change_k);
  }
}

void add_people(Panorama& room, Random& random, int fewest, int most) {
  for (int n = random.integer(fewest, most); n > 0; --n) add_person(room, random);
}

void add_screens(Panorama& room, Random& random) {
  for (int n = random.integer(2, 5); n > 0; --n) {
    const double low_deg = random.uniform(-12.0, -3.0);
    const double change_k = random.uniform(3.0, 12.0);
    add_to_patch(room, {any_azimuth(random), random.uniform(5.0, 12.0), low_deg, low_deg + 5.0}, change_k);
  }
}

void add_hot_things(Panorama& room, Random& random) {
  for (int n = random.integer(2, 5); n > 0; --n) {
    const double low_deg = random.uniform(-16.0, -4.0);
    const double change_k = random.uniform(5.0, 30.0);
    add_spot(room, {any_azimuth(random), random.uniform(1.0, 2.5), low_deg, low_deg + 2.0}, change_k);
  }
}

void add_kitchen_machines(Panorama& room, Random& random) {
  const double change_k = random.uniform(8.0, 40.0);
  add_spot(room, {any_azimuth(random), random.uniform(3.0, 6.0), -18.0, -14.0}, change_k);
  const double fridge_deg = any_azimuth(random);
  add_to_patch(room, {fridge_deg, 14.0, -40.0, 12.0}, -random.uniform(0.2, 1.0));
  add_to_patch(room, {fridge_deg, 8.0, -40.0, -34.0}, random.uniform(3.0, 8.0));
}

Panorama furnished_room(Random& random, double texture_k, int fewest_pieces, int most_pieces) {
  Panorama room = bare_room(random);
  add_texture(room, random, texture_k);
  add_corners(room, random);
  add_openings(room, random);
  add_ceiling(room, random);
  add_furniture(room, random, fewest_pieces, most_pieces);
  return room;
}

}  // namespace

Panorama laboratory_scene(Random& random) {
  Panorama room = furnished_room(random, 0.20, 5, 9);
  add_screens(room, random);
  add_people(room, random, 0, 1);
  return room;
}

Panorama dining_scene(Random& random) {
  Panorama room = furnished_room(random, 0.35, 12, 20);
  add_hot_things(room, random);
  add_people(room, random, 1, 5);
  return room;
}

Panorama kitchen_scene(Random& random) {
  Panorama room = furnished_room(random, 0.40, 12, 20);
  add_kitchen_machines(room, random);
  add_hot_things(room, random);
  add_people(room, random, 0, 2);
  return room;
}

}  // namespace thermorig::simulation

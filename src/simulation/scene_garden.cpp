// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <vector>

#include "scene_shapes.h"
#include "scenes.h"

namespace thermorig::simulation {
namespace {

struct Weather {
  double air_c;
  double sun;          // 0 overcast .. 1 full sun
  double sky_depth_k;  // how far the zenith lies below the air
};

Weather any_weather(Random& random) {
  return {random.uniform(24.0, 36.0), random.uniform(), random.uniform(14.0, 28.0)};
}

/// Height of the tree line in degrees for each azimuth, from a few harmonics.
std::vector<double> tree_line(Random& random) {
  std::vector<double> height(Panorama::azimuths, random.uniform(9.0, 15.0));
  for (int n = 1; n <= 24; ++n) {
    const double amplitude = random.normal(4.0 / std::sqrt(n));
    const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    for (int azimuth = 0; azimuth < Panorama::azimuths; ++azimuth)
      height[std::size_t(azimuth)] +=
          amplitude * std::cos(2.0 * std::numbers::pi * n * azimuth / Panorama::azimuths + phase);
  }
  return height;
}

double sky_c(const Weather& weather, double elevation) {
  return weather.air_c - weather.sky_depth_k * (0.25 + 0.75 * (1.0 - std::exp(-elevation / 20.0)));
}

/// Sky, trees with gaps in the leaves, sunlit ground.
Panorama open_land(Random& random, const Weather& weather) {
  Panorama land;
  const auto ground = fractal_texture(random);
  const auto leaves = fractal_texture(random);
  const auto height = tree_line(random);
  const double leaf_texture_k = random.uniform(0.7, 2.0);
  const double ground_texture_k = 0.8 + 2.2 * weather.sun;
  constexpr float gap_threshold = 1.3F;  // about one tenth of the crowns lets the sky through
  for (int row = 0; row < Panorama::elevations; ++row) {
    const double elevation = elevation_deg(row);
    for (int azimuth = 0; azimuth < Panorama::azimuths; ++azimuth) {
      const std::size_t i = std::size_t(row) * Panorama::azimuths + std::size_t(azimuth);
      const bool is_leaf = elevation < height[std::size_t(azimuth)] && leaves[i] < gap_threshold;
      double temp_c = sky_c(weather, elevation);
      if (elevation < 0.0)
        temp_c = weather.air_c + 2.0 + 10.0 * weather.sun + ground_texture_k * ground[i];
      else if (is_leaf)
        temp_c = weather.air_c + leaf_texture_k * leaves[i];
      land.temp_c[i] = static_cast<float>(temp_c);
    }
  }
  return land;
}

void add_walls(Panorama& land, Random& random, const Weather& weather) {
  for (int n = random.integer(1, 3); n > 0; --n) {
    const double surface_c = weather.air_c + 10.0 * weather.sun + random.normal(1.0);
    fill_patch(land, {any_azimuth(random), random.uniform(15.0, 40.0), -5.0, random.uniform(6.0, 16.0)},
               surface_c);
  }
}

void add_plants(Panorama& land, Random& random, const Weather& weather) {
  for (int n = random.integer(4, 12); n > 0; --n) {
    const double surface_c = weather.air_c + random.normal(1.0) + 2.0 * weather.sun;
    fill_patch(land, {any_azimuth(random), random.uniform(1.5, 4.0), -6.0, random.uniform(8.0, 20.0)},
               surface_c);
  }
  for (int n = random.integer(6, 16); n > 0; --n) {
    const double low_deg = random.uniform(-25.0, -6.0);
    const double surface_c = weather.air_c + random.normal(1.5) + 6.0 * weather.sun * random.uniform();
    fill_ellipse(land, {any_azimuth(random), random.uniform(4.0, 14.0), low_deg, low_deg + 8.0}, surface_c);
  }
}

}  // namespace

Panorama garden_scene(Random& random) {
  const Weather weather = any_weather(random);
  Panorama land = open_land(random, weather);
  add_walls(land, random, weather);
  add_plants(land, random, weather);
  for (int n = random.integer(0, 2); n > 0; --n) add_person(land, random);
  return land;
}

}  // namespace thermorig::simulation

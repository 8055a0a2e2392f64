// SPDX-License-Identifier: MIT
#include "scene_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::simulation {
namespace {

constexpr double to_deg = 180.0 / std::numbers::pi;

int row_at(double elevation) {
  const double row = (elevation - Panorama::lowest_elevation_deg) / Panorama::elevation_step_deg;
  return std::clamp(static_cast<int>(std::lround(row)), 0, Panorama::elevations - 1);
}

int wrapped(int azimuth) {
  return (azimuth % Panorama::azimuths + Panorama::azimuths) % Panorama::azimuths;
}

/// Calls change(temperature, x, y) for the patch's points; x and y run from -1 to 1 across it.
template <typename Change>
void over_patch(Panorama& panorama, const Patch& patch, const Change& change) {
  const double half_width = patch.width_deg / 2.0;
  const double middle = (patch.low_deg + patch.high_deg) / 2.0;
  const double half_height = (patch.high_deg - patch.low_deg) / 2.0;
  const int first =
      static_cast<int>(std::ceil((patch.azimuth_deg - half_width) / Panorama::azimuth_step_deg));
  const int last =
      static_cast<int>(std::floor((patch.azimuth_deg + half_width) / Panorama::azimuth_step_deg));
  for (int row = row_at(patch.low_deg); row <= row_at(patch.high_deg); ++row)
    for (int azimuth = first; azimuth <= last; ++azimuth)
      change(panorama.at(row, wrapped(azimuth)),
             (azimuth * Panorama::azimuth_step_deg - patch.azimuth_deg) / half_width,
             (elevation_deg(row) - middle) / half_height);
}

}  // namespace

double elevation_deg(int row) {
  return Panorama::lowest_elevation_deg + row * Panorama::elevation_step_deg;
}

double any_azimuth(Random& random) {
  return random.uniform(0.0, 360.0);
}

void add_to_patch(Panorama& panorama, const Patch& patch, double delta_k) {
  over_patch(panorama, patch, [&](float& temp, double, double) { temp += static_cast<float>(delta_k); });
}

void fill_patch(Panorama& panorama, const Patch& patch, double temp_c) {
  over_patch(panorama, patch, [&](float& temp, double, double) { temp = static_cast<float>(temp_c); });
}

void fill_ellipse(Panorama& panorama, const Patch& patch, double temp_c) {
  over_patch(panorama, patch, [&](float& temp, double x, double y) {
    if (x * x + y * y <= 1.0) temp = static_cast<float>(temp_c);
  });
}

void add_spot(Panorama& panorama, const Patch& patch, double delta_k) {
  const double middle = (patch.low_deg + patch.high_deg) / 2.0;
  const double height = patch.high_deg - patch.low_deg;
  const Patch wide{patch.azimuth_deg, 3.0 * patch.width_deg, middle - 1.5 * height, middle + 1.5 * height};
  over_patch(panorama, wide, [&](float& temp, double x, double y) {
    temp += static_cast<float>(delta_k * std::exp(-4.5 * (x * x + y * y)));
  });
}

void add_person(Panorama& panorama, Random& random) {
  const double distance_m = random.uniform(1.2, 4.5);
  const double azimuth = any_azimuth(random);
  const auto angle = [&](double metres) { return std::atan2(metres, distance_m) * to_deg; };
  constexpr double camera_height_m = 1.1;
  const double clothes_c = random.uniform(27.5, 30.5);
  const double head_c = random.uniform(32.0, 34.0);
  fill_patch(panorama, {azimuth, 2.0 * angle(0.22), angle(-camera_height_m), angle(1.45 - camera_height_m)},
             clothes_c);
  fill_ellipse(panorama,
               {azimuth, 2.0 * angle(0.085), angle(1.46 - camera_height_m), angle(1.70 - camera_height_m)},
               head_c);
}

}  // namespace thermorig::simulation

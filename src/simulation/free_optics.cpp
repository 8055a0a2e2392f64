// SPDX-License-Identifier: MIT
#include "free_optics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::simulation {
namespace {

constexpr double rad_a_deg = std::numbers::pi / 180.0;

}  // namespace

bool FreeOptics::is_needed(const CameraWorld& camera, const SceneWorld& scene) {
  const double sum = std::abs(camera.rolling_rows) + std::abs(camera.tilt_deg) + std::abs(camera.roll_deg) +
                     std::abs(camera.lever_arm_m) + std::abs(camera.pitch_error) +
                     std::abs(camera.distortion) + scene.person_dps + scene.pet_dps + scene.sun_k;
  return sum > 0.0;
}

FreeOptics::FreeOptics(const Panorama& panorama, const FieldOfView& view, bool mirrored,
                       const CameraWorld& camera, const SceneWorld& scene, std::uint64_t seed)
    : camera_(camera), scene_(scene), things_(scene, seed) {
  for (int row = 0; row < Panorama::elevations; ++row) {
    const double elevation_deg = Panorama::lowest_elevation_deg + row * Panorama::elevation_step_deg;
    for (const double temp_c : blurred_row(panorama, view, elevation_deg))
      blurred_c_.push_back(static_cast<float>(temp_c));
  }
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t row = 0; row < frame_rows; ++row)
      directions_[column_index(row, column)] =
          direction_of(column_azimuth_deg(view, mirrored, column), row_elevation_deg(view, row), view);
}

/// Of a pixel that an honest lens has so far off its axis: pitch and distortion, then roll, then tilt.
FreeOptics::Direction FreeOptics::direction_of(double across_deg, double up_deg,
                                               const FieldOfView& view) const {
  const double across_part = 2.0 * across_deg / view.width_deg, up_part = 2.0 * up_deg / view.height_deg;
  const double corner = (across_part * across_part + up_part * up_part) / 2.0;  // 1 in the corners
  const double wider = (1.0 + camera_.pitch_error) * (1.0 + camera_.distortion * corner);
  const double roll = rad_a_deg * camera_.roll_deg, tilt = rad_a_deg * camera_.tilt_deg;
  const double across = rad_a_deg * wider * (across_deg * std::cos(roll) - up_deg * std::sin(roll));
  const double up = rad_a_deg * wider * (across_deg * std::sin(roll) + up_deg * std::cos(roll));
  const double ahead = std::cos(up) * std::cos(across);
  const double level_ahead = ahead * std::cos(tilt) - std::sin(up) * std::sin(tilt);
  const double level_up = ahead * std::sin(tilt) + std::sin(up) * std::cos(tilt);
  return {std::atan2(std::cos(up) * std::sin(across), level_ahead) / rad_a_deg,
          std::asin(std::clamp(level_up, -1.0, 1.0)) / rad_a_deg};
}

/// By how much the azimuth about the shaft's axis is smaller than that about the camera before it.
double FreeOptics::parallax_deg(double azimuth_deg, double world_azimuth_deg) const {
  const double distance_m = scene_.distance_m * (1.0 + 0.5 * std::cos(rad_a_deg * world_azimuth_deg));
  return camera_.lever_arm_m / distance_m * std::sin(rad_a_deg * azimuth_deg) / rad_a_deg;
}

float FreeOptics::panorama_c(double azimuth_deg, double elevation_deg) const {
  constexpr double rows = Panorama::elevations - 1;
  const double up = std::clamp(
      (elevation_deg - Panorama::lowest_elevation_deg) / Panorama::elevation_step_deg, 0.0, rows - 1e-9);
  const double around = (azimuth_deg - 360.0 * std::floor(azimuth_deg / 360.0)) / Panorama::azimuth_step_deg;
  const auto row = static_cast<std::size_t>(up);
  const std::size_t left = static_cast<std::size_t>(around) % Panorama::azimuths;
  const std::size_t right = (left + 1) % Panorama::azimuths;
  const auto part = static_cast<float>(around - std::floor(around));
  const float* below = &blurred_c_[row * Panorama::azimuths];
  const float* above = below + Panorama::azimuths;
  return std::lerp(std::lerp(below[left], below[right], part), std::lerp(above[left], above[right], part),
                   static_cast<float>(up - static_cast<double>(row)));
}

void FreeOptics::view(const RowYaws& yaw_deg, double time_s, PixelColumns& temp_c) {
  things_.move_to(time_s);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    const Direction& direction = directions_[i];
    double azimuth_deg = yaw_deg[i % frame_rows] + direction.azimuth_deg;
    if (camera_.lever_arm_m != 0.0) azimuth_deg -= parallax_deg(direction.azimuth_deg, azimuth_deg);
    temp_c[i] = panorama_c(azimuth_deg, direction.elevation_deg);
    if (things_.are_there()) temp_c[i] = things_.seen_c(azimuth_deg, direction.elevation_deg, temp_c[i]);
  }
}

}  // namespace thermorig::simulation

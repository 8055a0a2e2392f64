// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "moving_things.h"
#include "optics.h"

namespace thermorig::simulation {

/// Where the camera looks while each of its rows is integrated, deg.
using RowYaws = std::array<double, frame_rows>;

/// A camera as it is mounted: each pixel looks in a direction of its own, each row at its own time, past what
/// moves, and from beside the shaft's axis. Slower than Optics, which has none of that.
class FreeOptics {
 public:
  FreeOptics(const Panorama& panorama, const FieldOfView& view, bool mirrored, const CameraWorld& camera,
             const SceneWorld& scene, std::uint64_t seed);

  /// Whether the world asks for it.
  static bool is_needed(const CameraWorld& camera, const SceneWorld& scene);

  /// What each pixel sees, in degrees Celsius.
  void view(const RowYaws& yaw_deg, double time_s, PixelColumns& temp_c);

 private:
  struct Direction {
    double azimuth_deg, elevation_deg;  // from where the camera looks, and from the horizon
  };
  Direction direction_of(double across_deg, double up_deg, const FieldOfView& view) const;
  double parallax_deg(double azimuth_deg, double world_azimuth_deg) const;
  float panorama_c(double azimuth_deg, double elevation_deg) const;

  CameraWorld camera_;
  SceneWorld scene_;
  MovingThings things_;
  std::vector<float> blurred_c_;                    // (181, 1440)
  std::array<Direction, frame_pixels> directions_;  // column after column
};

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::simulation {

/// What surrounds the rig: apparent temperatures all around the servo's axis, as seen from the camera, far
/// away (turning is the only motion, so there is no parallax).
struct Panorama {
  static constexpr int azimuths = 1440;   // 0.25 deg apart, growing to the right
  static constexpr int elevations = 181;  // 0.5 deg apart, row 0 at -45 deg
  static constexpr double azimuth_step_deg = 0.25;
  static constexpr double elevation_step_deg = 0.5;
  static constexpr double lowest_elevation_deg = -45.0;

  std::vector<float> temp_c = std::vector<float>(std::size_t{azimuths} * elevations);  // (181, 1440)

  float& at(int elevation, int azimuth) {
    return temp_c[static_cast<std::size_t>(elevation) * azimuths + static_cast<std::size_t>(azimuth)];
  }
  float at(int elevation, int azimuth) const {
    return temp_c[static_cast<std::size_t>(elevation) * azimuths + static_cast<std::size_t>(azimuth)];
  }
};

/// What the surroundings may be: laboratory, dining, kitchen, garden.
std::vector<std::string> scene_names();

/// The scene of the environment's name; the laboratory where there is none of it, so that a recording may
/// carry a name of its own.
std::string scene_of(std::string_view environment);

/// The surroundings of one acquisition; `scene` empty: that of the environment, scene_of(). Equal arguments
/// give equal panoramas; environments of one scene differ. Throws Error(bad_usage) if there is no such scene:
/// it lists those there are.
Panorama make_panorama(std::string_view environment, std::uint64_t seed, std::string_view scene = {});

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/camera.h"

namespace thermorig::simulation {

/// Frames of a camera that looks toward one direction, without any wire in between.
inline std::vector<SimulatedFrame> still_frames(const CameraConfig& config, const Panorama& panorama,
                                                std::uint64_t seed, double yaw_deg, std::size_t count) {
  Camera camera(config, panorama, seed);
  Shaft shaft(yaw_deg);
  std::vector<SimulatedFrame> frames;
  while (frames.size() < count) {
    for (int step = 0; step < 200; ++step) shaft.append(yaw_deg);
    for (auto& frame : camera.follow(shaft)) frames.push_back(frame);
  }
  frames.resize(count);
  return frames;
}

/// Frames of a camera that turns at a constant rate.
inline std::vector<SimulatedFrame> turning_frames(const CameraConfig& config, const Panorama& panorama,
                                                  std::uint64_t seed, double rate_dps, std::size_t count) {
  Camera camera(config, panorama, seed);
  Shaft shaft(0.0);
  std::vector<SimulatedFrame> frames;
  double angle_deg = 0.0;
  while (frames.size() < count) {
    for (int step = 0; step < 200; ++step) shaft.append(angle_deg += rate_dps * 1e-9 * Shaft::step_ns);
    for (auto& frame : camera.follow(shaft)) frames.push_back(frame);
  }
  frames.resize(count);
  return frames;
}

}  // namespace thermorig::simulation

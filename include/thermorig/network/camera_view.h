// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace thermorig::network {

/// What of a camera a network has learnt with its images.
struct CameraView {
  double width_deg = 55.0;  // horizontal field of view: 55 (BAB) or 110 (BAA), or as it was measured
  bool half_frames = true;  // half of a frame's pixels are new in it, the others as in the frame before
  bool mirrored = true;     // the order on the wire is a mirror image of the scene
  bool operator==(const CameraView&) const = default;

  /// May a network that learnt one be used with the other? Lenses differ by a few per cent within a type.
  bool fits(const CameraView& other) const {
    return half_frames == other.half_frames && mirrored == other.mirrored &&
           std::abs(std::log(width_deg / other.width_deg)) < 0.1;
  }
};

}  // namespace thermorig::network

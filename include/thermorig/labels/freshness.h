// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "thermorig/core/frame.h"

namespace thermorig::labels {

/// How the bridge fills its frames: one fresh chess half a frame, or both.
enum class CameraMode : std::uint8_t { half_fresh, full_fresh };

struct Freshness {
  std::uint16_t even = 0;  // pixels of the even half that differ from the frame before, 0..384
  std::uint16_t odd = 0;
  bool even_fresh() const { return even > threshold; }
  bool odd_fresh() const { return odd > threshold; }
  static constexpr std::uint16_t threshold = 384 / 50;  // 2 %
};

/// Exact comparison of a frame with the one before, by chess half. The first frame counts as wholly fresh.
class FreshnessDetector {
 public:
  Freshness push(const ThermalFrame& frame);

 private:
  std::optional<ThermalFrame> before_;
};

}  // namespace thermorig::labels

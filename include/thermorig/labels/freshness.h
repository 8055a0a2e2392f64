// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
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
  bool both_fresh() const { return even_fresh() && odd_fresh(); }
  bool one_fresh() const { return even_fresh() != odd_fresh(); }
  bool none_fresh() const { return !even_fresh() && !odd_fresh(); }
  static constexpr std::uint16_t threshold = 384 / 50;  // 2 %
};

/// Exact comparison of a frame with the one before, by chess half. The first frame counts as wholly fresh.
/// Not a number differs from everything.
class FreshnessDetector {
 public:
  Freshness push(const ThermalFrame& frame);

 private:
  std::optional<ThermalFrame> before_;
};

/// Decides between the camera's modes by majority of the frames seen so far. Frames that repeat the one
/// before say nothing; a tie is half-fresh. A frame after a lost one has both halves fresh in either mode,
/// which is why a single one decides nothing.
class ModeVote {
 public:
  /// The recording's first frame, which has nothing to differ from, must be left out.
  void push(const Freshness& freshness);
  CameraMode mode() const { return full_ > half_ ? CameraMode::full_fresh : CameraMode::half_fresh; }
  bool empty() const { return full_ + half_ == 0; }

 private:
  std::size_t half_ = 0;
  std::size_t full_ = 0;
};

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "thermorig/core/freshness.h"

namespace thermorig::labels {

/// How the bridge fills its frames: one fresh chess half a frame, or both.
enum class CameraMode : std::uint8_t { half_fresh, full_fresh };

using thermorig::Freshness;

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

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "thermorig/core/freshness.h"

namespace thermorig::labels {

/// How the bridge fills its frames: one fresh chess half a frame, or both.
enum class CameraMode : std::uint8_t { half_fresh, full_fresh };

using thermorig::Freshness;

/// What the fresh halves of a half-fresh source say of what lies between a frame and the one before it.
enum class HalvesWitness : std::uint8_t {
  unsure,            // one of the two repeats the frame before it, or that one brought both halves; or the
                     // source is not half-fresh
  none_missing,      // the halves take turns
  due_half_missing,  // the same half again: the other one never came, as a frame or within one
  frames_missing,    // both at once: a frame with the older one never came
};

inline bool may_be_missing(HalvesWitness halves) {
  return halves == HalvesWitness::due_half_missing || halves == HalvesWitness::frames_missing;
}

/// Hears them frame by frame. What follows a repeated frame shows what that one did not: both halves at once
/// mean nothing then.
class HalvesOrder {
 public:
  HalvesWitness push(const Freshness& freshness, CameraMode mode);

 private:
  Freshness before_;  // none fresh: nothing is known
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

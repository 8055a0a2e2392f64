// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "thermorig/core/sample.h"
#include "thermorig/network/soundness.h"

namespace thermorig::network {

/// How many of the last frames have a sound image and follow each other without lost frames or damaged bytes.
class FramesInARow {
 public:
  explicit FramesInARow(int most) : most_(most) {}

  /// The next frame. So many in a row up to it, at most `most`; 0 if its own image is not sound.
  int push(const TimedFrame& frame) {
    const bool gap_before = frame.resync_before || frame.missing_before > 0;
    count_ = !is_sound_image(frame.frame.temp_c) ? 0 : gap_before ? 1 : std::min(count_ + 1, most_);
    return count_;
  }

 private:
  int most_;
  int count_ = 0;
};

}  // namespace thermorig::network

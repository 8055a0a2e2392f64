// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "alignment.h"
#include "half_view.h"
#include "thermorig/core/sync.h"
#include "thermorig/fit/motion/panorama_fit.h"

namespace thermorig::motion {

/// What a recording offers to every question: its fresh halves, the gyro's angle, and what is known
/// beforehand.
struct Evidence {
  AngleTrack track;
  Prior prior;
  std::vector<FreshHalf> halves;
  std::string why_not;  // why nothing can be told, ready to print; empty: something may be told
};

/// `newer`: both halves of a frame must be fresh, and that one was exposed last.
Evidence gather(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                const GyroErrors& errors, NewerHalf newer = std::nullopt);

Layout layout_of(const View& view, bool closed);

/// Fewer halves than that tell nothing.
inline constexpr std::size_t fewest_halves = 40;

}  // namespace thermorig::motion

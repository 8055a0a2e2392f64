// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/labels/frame_gaps.h"

namespace thermorig::fit {

/// How the camera went over a whole recording: by which halves are fresh, and when its frames came.
struct CameraRhythm {
  std::optional<labels::CameraMode> mode;
  std::optional<double> period_s;      // time between frames
  std::vector<labels::FrameGap> gaps;  // before each frame; empty without a period
};

/// `frames` as a first pass stamped them. `pieces`: the first frame of each piece between two absences of the
/// camera; they have nothing to do with each other but the period, which is that of the longest one. Empty:
/// there was none.
CameraRhythm camera_rhythm(const std::vector<TimedFrame>& frames, std::span<const std::size_t> pieces = {});

}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/pipeline/labels/frame_gaps.h"
#include "thermorig/pipeline/labels/freshness.h"

namespace thermorig::pipeline {

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

/// Frames that an absence of the camera cost, between the last before it and the first after it: one at
/// least, so that no run goes on over it.
std::uint16_t missing_in_absence(HostTime last, HostTime first, double period_s);

}  // namespace thermorig::pipeline

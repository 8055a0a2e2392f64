// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/pipeline/labels/exposure.h"

namespace thermorig::fit {

/// Looks at a whole recording. A busy host delays reads, by seconds at times, and what queued up then comes
/// at once: such frames are late, none is missing. Frames are missing where the ones that follow never catch
/// up. `period_s` > 0: measured time between frames. One result a frame.
std::vector<labels::FrameGap> find_gaps(const std::vector<TimedFrame>& frames, double period_s,
                                        labels::CameraMode mode);

}  // namespace thermorig::fit

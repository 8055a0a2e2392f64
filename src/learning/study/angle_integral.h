// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

/// Integrates over the windows of one acquisition, in ascending order; at most so many points a line.
AngleTrack angle_track(std::span<const JudgedWindow> judged, const network::Acquisition& acquisition,
                       std::size_t points);

}  // namespace thermorig::study

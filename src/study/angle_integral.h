// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/study/evaluation.h"

namespace thermorig::study {

/// Integrates over the windows of one acquisition, in ascending order.
AngleTrack angle_track(std::span<const training::WindowEstimate> estimates,
                       std::span<const windows::Acquisition> acquisitions, const EvaluationConfig& config);

}  // namespace thermorig::study

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

/// Kg over the windows where it is a number.
GainStatistics gain_statistics(std::span<const JudgedWindow> judged);

/// Of all windows of all parts together; the median is interpolated within the histogram's bin.
GainStatistics merged(std::span<const GainStatistics> parts);

}  // namespace thermorig::study

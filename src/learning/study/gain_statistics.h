// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

/// Kg over the windows where it is a number.
GainStatistics gain_statistics(std::span<const JudgedWindow> judged);

/// Of all windows of all parts together; the median is interpolated within the histogram's bin.
GainStatistics merged(std::span<const GainStatistics> parts);

/// Nothing where no window has a sigma.
std::optional<GateSigma> gate_sigma(std::span<const JudgedWindow> judged);

}  // namespace thermorig::study

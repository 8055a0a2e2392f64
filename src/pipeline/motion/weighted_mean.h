// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/core/estimate.h"

namespace thermorig::motion {

/// Mean of estimates of one quantity, weighted by their certainty. Where they scatter more than their
/// uncertainties say, the scatter counts.
Estimate weighted_mean(std::span<const Estimate> estimates);

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/network/trainer.h"
#include "window_set.h"

namespace thermorig::training {

/// The network on every window of a set, in order; normalised.
std::vector<network::Output> estimates_of(const network::Weights& weights, const WindowSet& set);

/// Mean of (y_fus - y)^2 over a set, normalised; NaN without a window.
double mean_squared_error(const network::Weights& weights, const WindowSet& set);

}  // namespace thermorig::training

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/network/trainer.h"
#include "window_set.h"

namespace thermorig::training {

/// The network on every window of a set, in order, all turned alike; normalised, with the turn's sign.
std::vector<network::Output> estimates_of(const network::Weights& weights, const WindowSet& set,
                                          network::Turn turn = network::Turn());

/// Means of the squared errors over a set, normalised; NaN without a window.
struct SquaredErrors {
  double fusion = 0.0;   // (y_fus - y)^2
  double thermal = 0.0;  // (y_th - y)^2
};
SquaredErrors squared_errors(const network::Weights& weights, const WindowSet& set);

}  // namespace thermorig::training

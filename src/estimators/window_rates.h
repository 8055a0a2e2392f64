// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "thermorig/network/last_blocks.h"
#include "thermorig/network/window_index.h"

namespace thermorig::estimators {

/// Rates of the last frames, and their mean: unknown (NaN) before there were so many, and where one is.
class WindowRates {
 public:
  explicit WindowRates(int frames) : rates_dps_(static_cast<std::size_t>(frames), 1) {}

  /// The next frame's rate; returns the mean of the window that it ends.
  float add(float rate_dps) {
    rates_dps_.push(rate_dps);
    return network::mean_rate(rates_dps_.all());
  }

 private:
  network::LastBlocks rates_dps_;
};

}  // namespace thermorig::estimators

// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "thermorig/network/model/model.h"
#include "thermorig/network/window_index.h"

namespace thermorig::training {

/// What a model says of one window, beside the truth that it is held against. deg/s.
struct WindowEstimate {
  network::Window window;
  float label_dps = 0.0F;  // mean of the frames' labels
  float gyro_dps = 0.0F;   // mean of the frames' gyro means
  float thermal_dps = 0.0F;
  float fusion_dps = 0.0F;  // thermal-only: equal to thermal_dps
  float gain = 1.0F;
  float thermal_sigma_dps =
      std::numeric_limits<float>::quiet_NaN();  // as the gate states it; NaN: it does not
};

/// Runs the model over windows of acquisitions, in order. `turned`: 1, or 8 for the mean of each window's
/// eight turns; throws Error(bad_usage) for a model that has not learnt them.
std::vector<WindowEstimate> predict(const model::Model& model,
                                    std::span<const network::Acquisition> acquisitions,
                                    std::span<const network::Window> windows, int turned = 1);

}  // namespace thermorig::training

// SPDX-License-Identifier: MIT
#pragma once

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
};

/// Runs the model over windows of acquisitions, in order.
std::vector<WindowEstimate> predict(const model::Model& model,
                                    std::span<const network::Acquisition> acquisitions,
                                    std::span<const network::Window> windows);

}  // namespace thermorig::training

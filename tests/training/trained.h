// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "support/synthetic_acquisitions.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::training {

/// A network that trains in milliseconds: Nf = 2, Nr = 3.
inline TrainingConfig small_config(int epochs = 3) {
  TrainingConfig config = preset("paper");
  config.shape = {.frames = 2, .reduction = 3};
  config.epochs = epochs;
  return config;
}

/// 4 acquisitions of 44 windows.
inline std::vector<network::Acquisition> small_data() {
  return synthetic::make_acquisitions({"garden", "kitchen"}, 2, 1);
}

inline TrainingResult trained(const TrainingConfig& config,
                              const std::vector<network::Acquisition>& acquisitions,
                              const Observer& observer = {}, const std::optional<Checkpoint>& from = {}) {
  network::CallingThread workers;
  return train(config, acquisitions, workers, observer, from);
}

}  // namespace thermorig::training

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thermorig/learning/training/training.h"
#include "thermorig/network/window_index.h"

namespace thermorig::training {

/// Which windows train and which choose the epoch.
struct Division {
  std::vector<network::Window> training, held_out;
  std::optional<std::uint32_t> held_out_acquisition;
};

/// One acquisition that has windows is drawn by the seed and held out, if the epoch is to be chosen. Throws
/// Error(bad_usage) where nothing is left to train on.
Division divide(const TrainingConfig& config, std::span<const network::Acquisition> acquisitions);

}  // namespace thermorig::training

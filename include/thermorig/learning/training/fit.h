// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "thermorig/learning/training/training.h"
#include "thermorig/network/gate.h"

namespace thermorig::training {

/// How a trained model does on windows of its own training data, beside the gyro alone. Errors normalised.
struct Fit {
  std::uint64_t windows = 0;
  double network_mse = 0.0;                           // y_fus, or y_th of a thermal-only model
  double thermal_mse = 0.0;                           // y_th
  double gyro_mse = 0.0;                              // mean gyro of the window, bias not removed
  double gain_mean = 1.0;                             // of Kg
  double gain_below_002 = 0.0, gain_above_098 = 0.0;  // shares of the windows
};

struct Fits {
  Fit training;                 // the windows that it was trained on
  std::optional<Fit> held_out;  // those that chose the epoch
};

/// Of the model that `train` made with this configuration and these acquisitions.
Fits fits_of(const model::Model& model, const TrainingConfig& config,
             std::span<const network::Acquisition> acquisitions);

/// Does the gate of a fusion model give (almost) all to one side? Mean Kg below 0.02 or above 0.98.
inline bool gate_collapsed(double gain_mean) {
  return gain_mean < network::closed_gate || gain_mean > network::open_gate;
}

}  // namespace thermorig::training

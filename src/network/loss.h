// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/network/trainer.h"

namespace thermorig::network {

/// Paper eq. 3, mean over the errors. Puts the gradient with regard to each error in `slopes`.
double berhu(std::span<const double> errors, double fraction, std::span<double> slopes);

/// Of a batch of B windows, what the network said and what it should have said; all normalised.
struct BatchOutputs {
  std::span<const float> thermal;  // y_th
  std::span<const float> gain;     // Kg; empty for a thermal-only net
  std::span<const float> gyro;     // mean of the gyro; empty for a thermal-only net
  std::span<const float> label;
};

/// The loss of a batch, and its gradient with regard to y_th and to Kg before the sigmoid (left alone by a
/// thermal-only net).
StepLoss loss_of(const BatchOutputs& outputs, const LossConfig& config, std::span<float> thermal_gradient,
                 std::span<float> gain_gradient);

}  // namespace thermorig::network

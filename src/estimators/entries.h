// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

/// Entry::make of an estimator of that class.
template <typename Made>
std::unique_ptr<Estimator> made(const Setup& setup) {
  return std::make_unique<Made>(setup);
}

// Each in the file of its name; those of the network in network_estimators.cpp.
Entry gyro();
Entry gyro_rest();
Entry gyro_kalman();
Entry odometer();
Entry thermal_likelihood();
Entry cnn_thermal();
Entry cnn_fusion();
Entry cnn_fusion_kalman();

}  // namespace thermorig::estimators

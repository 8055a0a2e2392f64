// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

// Each in the file of its name; the two of the network in network_estimators.cpp.
Entry gyro();
Entry gyro_rest();
Entry gyro_kalman();
Entry cnn_thermal();
Entry cnn_fusion();

}  // namespace thermorig::estimators

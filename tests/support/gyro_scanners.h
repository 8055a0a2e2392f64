// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::test {

inline sensors::GyroScanner witmotion_scanner() {
  return sensors::gyro_scanner({.protocol = "witmotion"});
}

inline sensors::GyroScanner text_scanner(const TextColumns& columns,
                                         sensors::StreamStart start = sensors::StreamStart::anywhere) {
  return sensors::gyro_scanner({.protocol = "text", .text = columns}, start);
}

}  // namespace thermorig::test

// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/network/acquisition.h"

namespace thermorig::dataset {

/// SHA-256, hexadecimal, of what training and evaluation take from an acquisition: number of frames, pixels,
/// labels, gyro means, times since the first frame, runs, commanded speeds of the legs. Little-endian, every
/// NaN the same.
std::string data_hash(const network::Acquisition& acquisition);

}  // namespace thermorig::dataset

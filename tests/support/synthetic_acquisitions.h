// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/network/acquisition.h"

namespace thermorig::synthetic {

/// What the acquisitions hold: legs of constant speed in a scene of random bumps that the frames show moving.
struct AcquisitionConfig {
  std::vector<float> rates_dps{-150.0F, -75.0F, 75.0F, 150.0F};
  int frames_per_leg = 12;  // valid ones; between legs lie two frames that are not
  double frame_period_s = 0.125;
  float gyro_bias_dps = 10.0F;  // deviation of the bias from one acquisition to the next
  float gyro_noise_dps = 1.0F;
  float temp_noise_c = 0.1F;
};

/// One acquisition. Equal arguments give equal bits on every machine.
network::Acquisition make_acquisition(const std::string& environment, int number, std::uint64_t seed,
                                      const AcquisitionConfig& config = {});

/// `count` of each environment, numbered from 1.
std::vector<network::Acquisition> make_acquisitions(const std::vector<std::string>& environments, int count,
                                                    std::uint64_t seed, const AcquisitionConfig& config = {});

}  // namespace thermorig::synthetic

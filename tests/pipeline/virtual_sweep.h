// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::pipeline {

/// One leg that the servo is told to drive, back and forth where the travel demands it.
struct SweepLeg {
  double begin_s = 0.0;
  double duration_s = 0.0;
  double rate_dps = 0.0;
};

/// What a simulated rig sent while it drove some legs, and what really happened. Times count from 0.
struct VirtualSweep {
  simulation::VirtualRigConfig config;
  std::vector<Chunk> chunks;
  RawStream sent;  // to the servo
  std::vector<simulation::SentMessage> frames;
  std::vector<simulation::SentMessage> gyro;
  std::vector<simulation::TruthSample> shaft;  // a sample a millisecond
};

/// Greets, configures and arms the servo in the first second, drives the legs (numbered from 1) and feeds the
/// watchdog throughout.
VirtualSweep drive(const simulation::VirtualRigConfig& config, const std::vector<SweepLeg>& legs,
                   double duration_s);

}  // namespace thermorig::pipeline

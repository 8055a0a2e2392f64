// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "support/servo_script.h"
#include "thermorig/core/chunk.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::pipeline {

using SweepLeg = tests::ScriptedLeg;

/// What a simulated rig sent while it drove some legs, and what really happened. Times count from 0.
struct VirtualSweep {
  simulation::VirtualRigConfig config;
  std::vector<Chunk> chunks;
  RawStream sent;  // to the servo
  std::vector<simulation::SentMessage> frames;
  std::vector<simulation::SentMessage> gyro;
  std::vector<simulation::TruthSample> shaft;  // a sample a millisecond
};

/// Carries out servo_script() and feeds the watchdog throughout.
VirtualSweep drive(const simulation::VirtualRigConfig& config, const std::vector<SweepLeg>& legs,
                   double duration_s);

}  // namespace thermorig::pipeline

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/servo_script.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::motion {

/// Of the simulated servo; it turns back where its travel ends.
using Leg = tests::ScriptedLeg;

/// Frames and gyro samples of a simulated rig with the times that the simulator knows: what is left to find
/// is what images and gyro alone can tell.
struct Turning {
  std::vector<TimedFrame> frames;
  std::vector<TimedGyro> gyro;
  GyroErrors errors;        // as rests before and after would show them
  unsigned newer_half = 0;  // of a full-fresh frame
  double true_scale = 1.0;  // of this gyro: its readings against the shaft's true rates
};

Turning turn(const simulation::VirtualRigConfig& config, const std::vector<Leg>& legs, double duration_s);

/// Back and forth: `rate_dps` and its negative in turn, `leg_s` each, from 2 s on.
std::vector<Leg> back_and_forth(double rate_dps, double leg_s, double until_s);

/// Every frame's exposures as if they had been so much later.
void shift_frames(Turning& turning, double by_s);

/// Nothing to see but noise of that standard deviation, in Kelvin.
void make_wall(Turning& turning, float noise_k);

/// One of the four simulated environments for each seed, in turn.
std::string environment_of(unsigned seed);

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/measurement.h"
#include "thermorig/core/profile.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/simulation/virtual_rig.h"
#include "timing_rig.h"

namespace thermorig::bench {

/// What is recorded: the default rig, by default with a raw gyro and driven by the plan "paper".
struct OdometerCase {
  std::uint64_t seed = 1;
  std::string environment = "laboratory";
  std::string world = "honest";  // as --world takes it
  double field_of_view_deg = 55.0;
  double camera_rate_hz = 8.0;
  std::string plan = "paper";
  simulation::GyroGrade gyro_grade = simulation::GyroGrade::mpu6050_raw;
  double duration_s = 0.0;               // 0: that of the plan; longer: its legs again and again
  std::optional<RigProfile> calibrated;  // if not the one that the rig is sold with
};

/// The rig of a case, and what it does when a plan drives it: bytes and truth.
simulation::VirtualRigConfig rig_of(const OdometerCase& wanted);
Recorded drive(const OdometerCase& wanted, const rig::SweepPlan& plan);

/// What a live run sees of a recording, and what the shaft really did.
struct OdometerRecording {
  RigProfile profile;
  std::vector<Measurement> measurements;       // by causal clocks
  std::vector<simulation::TruthSample> shaft;  // a sample a millisecond
  double first_leg_s = 0.0;                    // since the first measurement
};

OdometerRecording record(const OdometerCase& wanted);

/// Of the shaft at a time between those of the recording.
double shaft_deg(const OdometerRecording& recording, HostTime time);

}  // namespace thermorig::bench

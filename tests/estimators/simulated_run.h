// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../pipeline/virtual_sweep.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

/// A rig whose profile states what its gyro's maker does: scale and bias as uncertain as they are.
simulation::VirtualRigConfig rig_of(std::uint64_t seed, simulation::GyroGrade grade, ServoKind servo);

/// Six legs with rests of some two seconds between them, and one of five before the first.
std::vector<pipeline::SweepLeg> six_legs();
inline constexpr double six_legs_s = 52.0;

/// What a live run of it sees, fed chunk by chunk.
std::vector<Measurement> measurements_of(const pipeline::VirtualSweep& sweep);

/// What the shaft of a simulated rig really did.
class ShaftTruth {
 public:
  explicit ShaftTruth(const std::vector<simulation::TruthSample>& shaft) : shaft_(shaft) {}
  double angle_deg(HostTime time) const;
  double mean_rate_dps(HostTime begin, HostTime end) const {
    return (angle_deg(end) - angle_deg(begin)) / to_s(end - begin);
  }

 private:
  const std::vector<simulation::TruthSample>& shaft_;
};

}  // namespace thermorig::estimators

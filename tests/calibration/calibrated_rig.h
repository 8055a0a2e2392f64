// SPDX-License-Identifier: MIT
#pragma once

#include <gmock/gmock.h>

#include <functional>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/simulation/virtual_rig.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::calibration {

using rig::CalibrationKind;
using ::testing::HasSubstr;

/// A simulated rig with the servo "winch", "180", "270" or "continuous".
simulation::VirtualRigConfig rig_with(std::uint64_t seed, const std::string& servo = "winch");

/// What the simulated gyro really does about the shaft, by all of its samples against the true rates.
struct GyroTruth {
  double scale = 1.0;
  double bias_dps = 0.0;
};

/// How far `rate_shaft` is from the shaft's true mean speed over the exposure, among valid frames.
struct LabelTruth {
  int frames = 0;
  double error_dps = 0.0;        // root mean square
  double uncertainty_dps = 0.0;  // as stated, mean
  double worst = 0.0;            // error over stated uncertainty
};

/// A session in virtual time with what is really true of it.
struct Recorded {
  session::Session session;
  GyroTruth gyro;
  LabelTruth label;
  double camera_latency_s = 0.0;  // least, from the end of the newest exposure to the first byte on the wire
  double gyro_latency_s = 0.0;    // least, from the middle of the averaging interval to the first byte
  double servo_scale = 1.0;       // true angle of the shaft over the commanded one, from one end to the other
};

/// Records `plan` on the rig, finalises, and gives the session.
Recorded record(const simulation::VirtualRigConfig& config, const rig::SweepPlan& plan);

/// The plan of a calibration on that rig.
rig::SweepPlan plan_for(CalibrationKind kind, const simulation::VirtualRigConfig& config);

/// What a measurement said that had to be refused, with the exit code and the advice of that.
std::string refusal(const std::function<void()>& measure);

}  // namespace thermorig::calibration

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"

namespace thermorig::rig {

/// Compares gyro and command while the first legs are driven, so that a gyro of another unit, range, sign or
/// axis is named before a recording is spent on it. It forgets what it heard once it has spoken, or after a
/// minute of legs, or some eight minutes since it began to listen.
class WitnessWatch {
 public:
  explicit WitnessWatch(const RigProfile& profile) : profile_(profile) {}

  void gyro(const TimedGyro& sample);
  /// A sentence that is ready to print, once, when the two contradict each other beyond what the profile
  /// states.
  std::optional<std::string> servo(const TimedServo& state);

 private:
  std::optional<std::string> compare();
  void stop();

  RigProfile profile_;
  std::vector<TimedGyro> gyro_;
  std::vector<TimedServo> servo_;
  double in_legs_s_ = 0.0;
  double compared_at_s_ = 0.0;
  bool done_ = false;
};

}  // namespace thermorig::rig

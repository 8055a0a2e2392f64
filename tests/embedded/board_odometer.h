// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "estimators/board_odometer/board_profile.h"
#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/sample.h"

namespace thermorig::tests {

/// A frame, and the gyro's samples before it, as the board's odometer is told them. A board knows which half
/// it has read; of a bridge's frames that tells what is fresh. Times: microseconds since `origin`.
struct BoardFrame {
  BoardFrame(const TimedFrame& timed, std::span<const TimedGyro> samples, const GyroProfile& profile,
             HostTime origin);

  struct Sample {
    std::uint32_t time_us = 0;
    std::array<float, 3> rate_dps{};
    std::uint32_t saturated = 0;
  };
  std::vector<Sample> gyro;
  thermorig_odometer_frame frame{};  // its image is that of `timed`
  std::uint32_t end_us = 0;          // of its exposure

  /// As odometer_main.c reads it.
  void append_to(std::string& bytes) const;
};

/// The C of an export, compiled for this machine, with the inputs and outputs of an estimator.
class BoardOdometer {
 public:
  /// `running`: for how long the board's clock has run when the first frame's exposure begins.
  explicit BoardOdometer(const RigProfile& rig, HostDuration running = std::chrono::seconds(1));

  RateEstimate add(const TimedFrame& frame, std::span<const TimedGyro> gyro);
  const thermorig_odometer_output& output() const { return output_; }
  /// What it says of so long after the newest frame's exposure.
  thermorig_odometer_output read_after(double seconds) const;

 private:
  GyroProfile gyro_;
  thermorig_odometer_profile profile_;
  std::shared_ptr<thermorig_odometer_state> state_;
  thermorig_odometer_output output_{};
  HostDuration running_;
  HostTime origin_{};
  std::uint32_t end_us_ = 0;
};

}  // namespace thermorig::tests

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/bad_pixels.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/estimator.h"
#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

/// What the servo is told to do, by its own telemetry. Once that has been silent, nothing is known.
class ServoOrder {
 public:
  void add(std::span<const TimedServo> states, HostTime now);

  std::optional<HostTime> still_since() const { return still_since_; }
  bool is_to_move() const { return last_ && !still_since_; }

 private:
  void add(const TimedServo& state);

  std::optional<HostTime> still_since_, last_;
};

/// Shows each estimator of a measurement what its entry declares, and nothing else: images without the
/// camera's bad pixels, and nothing whose value or time is no number.
class Observer {
 public:
  Observer() { sound_gyro_.reserve(512); }  // more than any frame has

  /// `measurement` must outlive the observations of it.
  void take(const Measurement& measurement);

  /// Of the measurement that was taken last.
  Observation seen_with(const Inputs& inputs) const;

  /// Gyro samples and frames so far that were not shown since something of them is no number.
  std::uint64_t ignored() const { return ignored_; }

 private:
  void take_gyro(std::span<const TimedGyro> gyro);
  void take_frame(const TimedFrame& frame);

  const Measurement* measurement_ = nullptr;
  TimedFrame blank_;                  // its frame without what was seen
  TimedFrame mended_;                 // its frame without bad pixels
  const TimedFrame* seen_ = nullptr;  // its frame, or one of these two
  std::span<const TimedGyro> gyro_;
  std::vector<TimedGyro> sound_gyro_;  // where not all of them are
  PixelWatch pixels_;
  std::uint64_t ignored_ = 0;
  ServoOrder order_;
  std::uint64_t count_ = 0;
};

}  // namespace thermorig::estimators

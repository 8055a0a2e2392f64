// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

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

/// Shows each estimator of a measurement what its entry declares, and nothing else.
class Observer {
 public:
  /// `measurement` must outlive the observations of it.
  void take(const Measurement& measurement);

  /// Of the measurement that was taken last.
  Observation seen_with(const Inputs& inputs) const;

 private:
  const Measurement* measurement_ = nullptr;
  TimedFrame blank_;  // its frame without what was seen
  ServoOrder order_;
  std::uint64_t count_ = 0;
};

}  // namespace thermorig::estimators

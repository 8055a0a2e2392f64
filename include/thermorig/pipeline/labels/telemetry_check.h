// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "thermorig/core/sample.h"
#include "thermorig/pipeline/labels/pulse_scale.h"

namespace thermorig::labels {

/// Whether the micro-controller does what it says. Telemetry that reports pulses is due every 10 ms of its
/// clock, exactly; and a pulse shows what was commanded at most one pulse period and one step of the motion
/// law before it (protocols/servo_link.md, "Motion").
class TelemetryCheck {
 public:
  explicit TelemetryCheck(const PulseScale& scale) : scale_(scale) {}

  /// True if the message came at another time than it was due, though none before it was lost on the line; or
  /// if its pulse lies outside what was commanded over the last 30 ms by more than half a microsecond.
  bool disagrees(const TimedServo& servo);

 private:
  static constexpr std::size_t kept = 4;  // messages that cover a pulse period and a step
  bool missed_deadline(const TimedServo& servo) const;
  bool pulse_strays(const ServoState& state) const;

  PulseScale scale_;
  std::array<double, kept> commanded_{};  // a ring
  std::size_t count_ = 0;                 // messages since the last loss
  std::int64_t before_us_ = 0;
};

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/telemetry_check.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::labels {

namespace {
constexpr std::int64_t tolerance_us = 1'000;  // one step of the motion law
constexpr double coarsest_tick_us = 0.5;
constexpr double resolution = 0.01;  // telemetry counts hundredths
}  // namespace

/// A servo that puts out no pulses sends when it is asked.
bool TelemetryCheck::missed_deadline(const TimedServo& servo) const {
  return count_ > 0 && servo.state.pulse_us > 0.0F &&
         std::abs(servo.mcu_time_us - before_us_ - message_us) > tolerance_us;
}

bool TelemetryCheck::pulse_strays(const ServoState& state) const {
  if (count_ < kept || state.pulse_us <= 0.0F || state.motion == ServoMotion::disarmed) return false;
  const auto [low, high] = std::minmax_element(commanded_.begin(), commanded_.end());
  const double value = scale_.value(static_cast<double>(state.pulse_us));
  const double tolerance = scale_.value_of_width(coarsest_tick_us) + resolution;
  return !(value >= *low - tolerance && value <= *high + tolerance);
}

bool TelemetryCheck::disagrees(const TimedServo& servo) {
  if (servo.lost_before) count_ = 0;
  const bool missed = missed_deadline(servo);
  if (missed) count_ = 0;
  commanded_[count_ % kept] = scale_.continuous() ? servo.state.rate_dps : servo.state.angle_deg;
  ++count_;
  before_us_ = servo.mcu_time_us;
  return pulse_strays(servo.state) || missed;
}

}  // namespace thermorig::labels

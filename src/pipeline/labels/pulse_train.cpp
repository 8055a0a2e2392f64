// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/pulse_train.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace thermorig::labels {

namespace {
constexpr double least_width_us = 1.0;  // of a profile that makes no sense
constexpr double least_span = 1.0;
}  // namespace

PulseScale::PulseScale(const ServoProfile& servo)
    : continuous_(servo.kind == ServoKind::continuous),
      middle_us_((servo.pulse_min_us + servo.pulse_max_us) / 2.0),
      half_span_(std::max(continuous_ ? servo.full_rate_dps : servo.travel_deg / 2.0, least_span)),
      value_per_us_(half_span_ / std::max((servo.pulse_max_us - servo.pulse_min_us) / 2.0, least_width_us)) {}

namespace {
constexpr double least_change = 1e-9;
// So close that the steps from one to the next do not show in the shaft, however fast it follows.
constexpr std::int64_t stand_in_us = 5'000;
constexpr double share_of_step = 0.02;  // of what a message's angle differs by from the one that was taken on
constexpr double latest_s = 0.03;       // more than this, by time or angle, is another motion
constexpr double coarsest_deg = 0.2;
// A shaft strays from what is commanded, by play and stick-slip: 2 degrees leave less than 1 deg/s. A servo
// that turns 2 % faster or slower than it should is followed, too.
constexpr double strays_deg = 4.0, share_of_measured = 0.01;

/// a modulo b, not negative.
std::int64_t modulo(std::int64_t a, std::int64_t b) {
  const std::int64_t rest = a % b;
  return rest < 0 ? rest + b : rest;
}
}  // namespace

PulseTrain::PulseTrain(const PulseScale& scale, HostDuration gap)
    : scale_(scale), gap_us_(std::chrono::duration_cast<std::chrono::microseconds>(gap).count()) {}

double PulseTrain::value(const ServoState& state) const {
  const double commanded = scale_.continuous() ? state.rate_dps : state.angle_deg;
  const double value = state.pulse_us > 0.0F ? scale_.value(static_cast<double>(state.pulse_us)) : commanded;
  return std::isfinite(value) ? value : 0.0;
}

double PulseTrain::taken_on(const TimedServo& servo, double value) const {
  const double rate_dps = servo.state.rate_dps;
  const bool has_steps = servo.state.pulse_us <= 0.0F && !scale_.continuous();
  if (!has_steps || rate_dps == 0.0 || rate_dps != before_->rate_dps) return value;
  const double expected =
      before_->value + rate_dps * 1e-6 * static_cast<double>(servo.mcu_time_us - before_->time_us);
  const double off = value - expected;
  const bool measured = servo.state.is_measured;
  const double most_deg = std::abs(rate_dps) * latest_s + (measured ? strays_deg : coarsest_deg);
  return std::abs(off) <= most_deg ? expected + (measured ? share_of_measured : share_of_step) * off : value;
}

/// Start of the pulse that a message at `time_us` reports.
std::int64_t PulseTrain::start_us(std::int64_t time_us) const {
  return phase_us_ ? time_us - modulo(time_us - *phase_us_, period_us) : time_us;
}

void PulseTrain::learn_phase(const TimedServo& servo, double value) {
  if (!before_ || std::abs(value - before_->value) < least_change) return;
  const std::int64_t step_us = servo.mcu_time_us - before_->time_us;
  if (step_us > 0 && step_us < message_us + message_us / 2) phase_us_ = modulo(servo.mcu_time_us, period_us);
}

/// The pulses from the one after last_ up to `pulse`.
void PulseTrain::fill(const TimedServo& servo, const Seen& pulse, std::vector<Pulse>& out) const {
  const bool stands_in = servo.state.pulse_us <= 0.0F;
  const std::int64_t span_us = pulse.time_us - last_->time_us;
  const std::int64_t steps = std::max<std::int64_t>(span_us / (stands_in ? stand_in_us : period_us), 1);
  const std::int64_t spacing_us = stands_in ? span_us / steps : period_us;
  for (std::int64_t i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    const std::int64_t start_us = pulse.time_us - (steps - i) * spacing_us;
    const auto width_us =
        std::chrono::duration<double, std::micro>(static_cast<double>(servo.state.pulse_us));
    const auto age = std::chrono::microseconds(servo.mcu_time_us - start_us);
    out.push_back({.end = servo.stamp.time - age + std::chrono::duration_cast<HostDuration>(width_us),
                   .start_us = start_us,
                   .value = last_->value + share * (pulse.value - last_->value),
                   .rate_dps = std::isfinite(servo.state.rate_dps) ? servo.state.rate_dps : 0.0});
  }
}

void PulseTrain::add(const TimedServo& servo, std::vector<Pulse>& out) {
  const bool unbroken = before_ && std::abs(servo.mcu_time_us - before_->time_us) <= gap_us_;
  const double now = unbroken ? taken_on(servo, value(servo.state)) : value(servo.state);
  if (unbroken && servo.state.pulse_us > 0.0F) learn_phase(servo, now);
  const Seen pulse{start_us(servo.mcu_time_us), now};
  const bool stands_in = servo.state.pulse_us <= 0.0F;
  if (!unbroken) last_ = Seen{pulse.time_us - (stands_in ? stand_in_us : period_us), now};
  if (pulse.time_us > last_->time_us) {
    const std::size_t first = out.size();
    fill(servo, pulse, out);
    out[first].restart = !unbroken;
    last_ = pulse;
  }
  before_ = Seen{servo.mcu_time_us, now, servo.state.rate_dps};
}

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

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/pulse_train.h"

#include <algorithm>
#include <cmath>

namespace thermorig::labels {

namespace {
constexpr double least_change = 1e-9;
// So close that the steps from one to the next do not show in the shaft, however fast it follows.
constexpr std::int64_t stand_in_us = 5'000;
constexpr double share_of_step = 0.02;  // of what a message's angle differs by from the one that was taken on
constexpr double latest_s = 0.03;       // more than this, by time or angle, is another motion
constexpr double coarsest_deg = 0.2;

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
  return std::abs(off) <= std::abs(rate_dps) * latest_s + coarsest_deg ? expected + share_of_step * off
                                                                       : value;
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

}  // namespace thermorig::labels

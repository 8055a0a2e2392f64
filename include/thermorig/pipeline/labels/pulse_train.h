// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::labels {

/// What a pulse width commands by the profile of the servo. Source: protocols/servo_link.md, "Motion".
class PulseScale {
 public:
  explicit PulseScale(const ServoProfile& servo);

  /// A continuous servo is commanded a speed, a positional one an angle.
  bool continuous() const { return continuous_; }

  /// Positional: degrees, 0 in the middle of the travel. Continuous: degrees per second.
  double value(double pulse_us) const { return (pulse_us - middle_us_) * value_per_us_; }

  /// Degrees, or degrees per second, of so many microseconds.
  double value_of_width(double width_us) const { return width_us * value_per_us_; }

  /// Where a value lies between the shortest pulse (-1) and the longest (1).
  double part(double value) const { return value / half_span_; }

 private:
  bool continuous_;
  double middle_us_;
  double half_span_;
  double value_per_us_;
};

/// Of the servo's pulses, as a duration and in seconds; telemetry comes twice as often
/// (protocols/servo_link.md, "Telemetry").
inline constexpr HostDuration pulse_period = std::chrono::milliseconds(20);
inline constexpr double pulse_period_s = 1e-6 * 20'000;
inline constexpr std::int64_t message_us = 10'000;

/// One pulse on the servo's pin.
struct Pulse {
  HostTime end{};             // only now the servo knows its width
  std::int64_t start_us = 0;  // by the micro-controller's clock
  double value = 0.0;         // commanded angle, deg, or rate, deg/s
  double rate_dps = 0.0;      // reported with it
  bool restart = false;       // what came before it is not known
};

/// The pulses behind the telemetry, which reports the last pulse that was started. Telemetry comes every 10
/// ms, pulses every 20 ms of the same clock: where the width changes from one message to the next, a pulse
/// started with the message, and from then on their phase is known. Pulses that no message showed are taken
/// to run straight between their neighbours.
class PulseTrain {
 public:
  static constexpr std::int64_t period_us = 20'000;

  /// More than `gap` between two messages, by the servo's clock, is a gap: what came in it is not known.
  PulseTrain(const PulseScale& scale, HostDuration gap);

  /// Appends the pulses that the message tells of. Where an armed servo reports no pulse, the commanded angle
  /// (or rate) of the message stands in for it: while the speed stays the same, as that speed takes it on,
  /// for the message's angle and time have steps, and the speed has none.
  void add(const TimedServo& servo, std::vector<Pulse>& out);

 private:
  struct Seen {
    std::int64_t time_us = 0;
    double value = 0.0;
    double rate_dps = 0.0;
  };
  double value(const ServoState& state) const;
  double taken_on(const TimedServo& servo, double value) const;
  std::int64_t start_us(std::int64_t time_us) const;
  void learn_phase(const TimedServo& servo, double value);
  void fill(const TimedServo& servo, const Seen& pulse, std::vector<Pulse>& out) const;

  PulseScale scale_;
  std::int64_t gap_us_;
  std::optional<Seen> before_;            // the last message
  std::optional<Seen> last_;              // the last pulse, by its start
  std::optional<std::int64_t> phase_us_;  // start of a pulse, modulo the period
};

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

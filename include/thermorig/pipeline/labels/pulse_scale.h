// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/profile.h"

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

}  // namespace thermorig::labels

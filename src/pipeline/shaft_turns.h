// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"

namespace thermorig::pipeline {

/// Counts the turns of a shaft whose sensor knows the angle within one turn, and takes off what the profile
/// knows of that sensor.
class ShaftTurns {
 public:
  explicit ShaftTurns(const EncoderProfile& encoder) : encoder_(encoder) {}

  /// Half a turn takes longer at any speed that a rig can have; what passed in a longer silence is not known.
  static constexpr std::int64_t longest_silence_us = 300'000;

  /// Fills in its angle, and whether turns are counted anew from here on.
  void count(bool lost_before, TimedShaft& shaft) {
    const ShaftReading& reading = shaft.reading;
    if (!has_angle(reading) || !std::isfinite(reading.angle_deg)) return;
    const double turn_deg = reading.turn_deg;
    const bool silent = last_ && !(shaft.mcu_time_us >= last_->mcu_time_us &&
                                   shaft.mcu_time_us - last_->mcu_time_us <= longest_silence_us);
    shaft.lost_before = !last_ || silent || (lost_before && turn_deg == 0.0);
    double sent_deg = reading.angle_deg;
    if (!shaft.lost_before && turn_deg > 0.0)
      sent_deg += turn_deg * std::round((last_->sent_deg - sent_deg) / turn_deg);
    shaft.angle_deg = encoder_.angle_deg(sent_deg);
    last_ = Last{shaft.mcu_time_us, sent_deg};
  }

  /// The device was away.
  void restart() { last_.reset(); }

 private:
  struct Last {
    std::int64_t mcu_time_us;
    double sent_deg;  // turns counted
  };
  EncoderProfile encoder_;
  std::optional<Last> last_;
};

}  // namespace thermorig::pipeline

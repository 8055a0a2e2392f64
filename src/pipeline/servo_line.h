// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/timing/link_timing.h"
#include "thermorig/timing/mcu_time.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::pipeline {

/// Servo bytes to telemetry with its time, pongs, and the answers that the rig's servo link waits for.
class ServoLine {
 public:
  explicit ServoLine(const ServoProfile& profile);

  /// Appends what the chunk completes to `out` and returns its telemetry.
  std::span<const TimedServo> push(std::span<const std::uint8_t> chunk, HostTime arrived, Streams& out);

  const wire::Counters& counters() const { return scanner_.counters(); }

 private:
  void sort(wire::ServoMessage&& message, Streams& out);
  TimedServo timed(const wire::ServoMessage& message, const ServoState& state, const Stamp& stamp);

  wire::ServoScanner scanner_;
  timing::LinkTiming timing_;
  timing::McuTime mcu_time_;
  std::vector<wire::ServoMessage> messages_;  // empty between calls; kept for its memory
};

}  // namespace thermorig::pipeline

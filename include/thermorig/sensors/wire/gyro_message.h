// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/chunk.h"
#include "thermorig/core/reading.h"

namespace thermorig::wire {

/// One sample in a gyro's stream of bytes.
struct GyroMessage {
  GyroReading reading;
  StreamSpan span;
  bool lost_before =
      false;  // bytes were skipped or damaged since the message before, or messages are missing
};

}  // namespace thermorig::wire

// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/sample.h"

namespace thermorig {

/// One frame with its label and everything that was measured since the frame before.
struct Measurement {
  TimedFrame frame;               // without an image where it stands in for one of a camera that is missing
  LabelledSample sample;          // its label
  std::vector<TimedGyro> gyro;    // those up to the frame's exposure_end that no measurement before has; a
                                  // sample that came later than its frame could wait is in the next one
  std::vector<TimedServo> servo;  // the same of the servo's states
};

}  // namespace thermorig

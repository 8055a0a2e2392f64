// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::session {

/// The servo is told to stand still, from `begin` to before `end`.
struct Rest {
  HostTime begin{};
  HostTime end{};
};

/// Those of a recording, in order, without the second that it has to come to rest.
std::vector<Rest> servo_rests(std::span<const TimedServo> servo);

}  // namespace thermorig::session

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::session {

/// From `begin` to before `end`.
struct Stretch {
  HostTime begin{};
  HostTime end{};
};

/// Stretches in which the servo was told to stand still and had a second to come to rest, in order.
std::vector<Stretch> servo_rests(std::span<const TimedServo> servo);

}  // namespace thermorig::session

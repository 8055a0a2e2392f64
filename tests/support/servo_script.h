// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::tests {

/// One leg that the servo is told to drive, back and forth where the travel demands it.
struct ScriptedLeg {
  double begin_s = 0.0;
  double duration_s = 0.0;
  double rate_dps = 0.0;
};

struct ServoOrder {
  double time_s = 0.0;
  std::vector<std::uint8_t> bytes;
};

/// Greets, configures and arms the servo in the first second, then drives the legs, numbered from 1.
inline std::vector<ServoOrder> servo_script(const ServoProfile& servo, const std::vector<ScriptedLeg>& legs) {
  std::uint8_t sequence = 0;
  std::vector<ServoOrder> script{{0.3, wire::hello_bytes(sequence)}};
  script.push_back({0.4, wire::configure_bytes(++sequence, servo)});
  script.push_back({0.5, wire::arm_bytes(++sequence, 0.0)});
  std::uint16_t number = 0;
  for (const ScriptedLeg& leg : legs)
    script.push_back({leg.begin_s, wire::run_bytes(++sequence, {.leg = ++number,
                                                                .turn_back = true,
                                                                .rate_dps = leg.rate_dps,
                                                                .acceleration_dps2 = servo.acceleration_dps2,
                                                                .duration_s = leg.duration_s})});
  return script;
}

}  // namespace thermorig::tests

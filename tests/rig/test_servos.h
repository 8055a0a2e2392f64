// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/profile.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::rig::test {

/// The simulated rig's servo, with that travel.
inline ServoProfile servo_of(double travel_deg) {
  ServoProfile servo = simulation::default_profile().servo;
  servo.travel_deg = travel_deg;
  return servo;
}

inline ServoProfile continuous_servo() {
  ServoProfile servo = servo_of(0.0);
  servo.kind = ServoKind::continuous;
  servo.full_rate_dps = 300.0;
  return servo;
}

}  // namespace thermorig::rig::test

// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/servo_driver.h"

#include "thermorig/rig/sweep/dynamixel_driver.h"
#include "thermorig/rig/sweep/grbl_driver.h"
#include "thermorig/rig/sweep/servo_commander.h"

namespace thermorig::rig {

std::unique_ptr<ServoDriver> make_servo_driver(const ServoProfile& servo) {
  if (servo.protocol == "dynamixel") return std::make_unique<DynamixelDriver>(servo);
  if (servo.protocol == "grbl") return std::make_unique<GrblDriver>(servo);
  return std::make_unique<ServoCommander>(servo);
}

}  // namespace thermorig::rig

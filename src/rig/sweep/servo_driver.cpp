// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/servo_driver.h"

#include "thermorig/rig/sweep/servo_commander.h"

namespace thermorig::rig {

// Each in the file of its name.
std::unique_ptr<ServoDriver> make_dynamixel_driver(const ServoProfile& servo);
std::unique_ptr<ServoDriver> make_grbl_driver(const ServoProfile& servo);
std::unique_ptr<ServoDriver> make_sts3215_driver(const ServoProfile& servo);

std::unique_ptr<ServoDriver> make_servo_driver(const ServoProfile& servo) {
  if (servo.protocol == "dynamixel") return make_dynamixel_driver(servo);
  if (servo.protocol == "grbl") return make_grbl_driver(servo);
  if (servo.protocol == "sts3215") return make_sts3215_driver(servo);
  return std::make_unique<ServoCommander>(servo);
}

}  // namespace thermorig::rig

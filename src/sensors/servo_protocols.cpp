// SPDX-License-Identifier: MIT
#include <array>

#include "protocol_table.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::sensors {

// Each in the file of its name.
ServoProtocol servo_link_servo();
ServoProtocol dynamixel_servo();
ServoProtocol grbl_servo();
ServoProtocol sts3215_servo();

std::span<const ServoProtocol> servo_protocols() {
  static const std::array table{servo_link_servo(), dynamixel_servo(), grbl_servo(), sts3215_servo()};
  return table;
}

std::vector<std::string> servo_protocol_names() {
  return names_in(servo_protocols());
}

const ServoProtocol* find_servo_protocol(std::string_view name) {
  return find_in(servo_protocols(), name);
}

const ServoProtocol& servo_protocol(std::string_view name) {
  return required_in(servo_protocols(), name, "servo");
}

void choose_servo(std::string_view protocol, ServoProfile& profile) {
  const ServoProtocol& chosen = servo_protocol(protocol);
  if (profile.protocol == protocol) return;
  profile.protocol = protocol;
  profile.link.baud = chosen.bauds.front().baud;
}

}  // namespace thermorig::sensors

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "protocol_table.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::sensors {

// Each in the file of its name.
GyroProtocol witmotion_gyro();
GyroProtocol text_gyro();
GyroProtocol mavlink_gyro();
GyroProtocol vectornav_gyro();
GyroProtocol xsens_gyro();
GyroProtocol hipnuc_gyro();
GyroProtocol mip_gyro();

std::span<const GyroProtocol> gyro_protocols() {
  static const std::array table{witmotion_gyro(), text_gyro(),   mavlink_gyro(), vectornav_gyro(),
                                xsens_gyro(),     hipnuc_gyro(), mip_gyro()};
  return table;
}

std::vector<std::string> gyro_protocol_names() {
  return names_in(gyro_protocols());
}

const GyroProtocol* find_gyro_protocol(std::string_view name) {
  return find_in(gyro_protocols(), name);
}

const GyroProtocol& gyro_protocol(std::string_view name) {
  return required_in(gyro_protocols(), name, "gyro");
}

bool is_allowed(const GyroProtocol& protocol, std::string_view setting, double value) {
  return std::any_of(protocol.settings.begin(), protocol.settings.end(), [&](const GyroSetting& known) {
    return known.name == setting && value >= known.min && value <= known.max &&
           (!known.is_whole || value == std::trunc(value));
  });
}

GyroScanner gyro_scanner(const GyroProfile& profile, StreamStart start) {
  return gyro_protocol(profile.protocol).scanner(profile, start);
}

}  // namespace thermorig::sensors

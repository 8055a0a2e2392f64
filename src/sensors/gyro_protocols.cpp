// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::sensors {

// Each in the file of its name.
GyroProtocol witmotion_gyro();
GyroProtocol text_gyro();
GyroProtocol mavlink_gyro();

std::span<const GyroProtocol> gyro_protocols() {
  static const std::array table{witmotion_gyro(), text_gyro(), mavlink_gyro()};
  return table;
}

std::vector<std::string> gyro_protocol_names() {
  std::vector<std::string> names;
  for (const GyroProtocol& protocol : gyro_protocols()) names.emplace_back(protocol.name);
  return names;
}

const GyroProtocol* find_gyro_protocol(std::string_view name) {
  const auto table = gyro_protocols();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const GyroProtocol& protocol) { return protocol.name == name; });
  return found == table.end() ? nullptr : &*found;
}

const GyroProtocol& gyro_protocol(std::string_view name) {
  if (const GyroProtocol* found = find_gyro_protocol(name)) return *found;
  throw Error(ExitCode::bad_usage, fmt::format("the gyro protocol \"{}\" is not known", name),
              "the gyro's protocol", advice_on_name(name, gyro_protocol_names()));
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

// SPDX-License-Identifier: MIT
#include <array>

#include "protocol_table.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::sensors {

// Each in the file of its name.
CameraProtocol gy_mcu90640_camera();
CameraProtocol text_camera();
CameraProtocol binary_camera();

std::span<const CameraProtocol> camera_protocols() {
  static const std::array table{gy_mcu90640_camera(), text_camera(), binary_camera()};
  return table;
}

std::vector<std::string> camera_protocol_names() {
  return names_in(camera_protocols());
}

const CameraProtocol& camera_protocol(std::string_view name) {
  return required_in(camera_protocols(), name, "camera");
}

CameraScanner camera_scanner(const CameraProfile& profile) {
  return camera_protocol(profile.protocol).scanner(profile);
}

}  // namespace thermorig::sensors

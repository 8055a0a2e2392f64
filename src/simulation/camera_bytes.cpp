// SPDX-License-Identifier: MIT
#include <array>

#include "camera.h"
#include "encoder_table.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

std::vector<std::uint8_t> gy_mcu90640_bytes(const SimulatedFrame& frame, const CameraProfile&) {
  return wire::camera_frame(frame.frame);
}

constexpr std::array all_camera_encoders{CameraEncoder{"gy-mcu90640", gy_mcu90640_bytes}};

}  // namespace

std::span<const CameraEncoder> camera_encoders() {
  return all_camera_encoders;
}

const CameraEncoder& camera_encoder(const CameraProfile& profile) {
  return encoder_named(camera_encoders(), profile.protocol, "camera");
}

}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "protocol_table.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::sensors {

// Each in the file of its name.
CameraProtocol gy_mcu90640_camera();
CameraProtocol text_camera();
CameraProtocol binary_camera();
CameraProtocol i2c_stick_camera();
CameraProtocol mlx_raw_camera();

std::string advice_on_unit(const ThermalFrame& frame) {
  const auto [low, high] = std::minmax_element(frame.temp_c.begin(), frame.temp_c.end());
  if (*low >= 0.0F && *high <= 1.0F && *low < *high)
    return "its values lie between 0 and 1: print degrees Celsius in the sketch";
  if (*low > 200.0F) return "its values look like Kelvin: print degrees Celsius in the sketch";
  return "";
}

std::string doubt_on_unit(const ThermalFrame& frame) {
  const float low = *std::min_element(frame.temp_c.begin(), frame.temp_c.end());
  if (low <= 45.0F || !advice_on_unit(frame).empty()) return "";
  return fmt::format("its coldest pixel is {:.1f}: if nothing there is so hot, these are degrees Fahrenheit",
                     low);
}

bool is_half_an_image(std::span<const float, frame_pixels> temp_c) {
  std::array<std::size_t, 2> zeros{};
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    if (temp_c[pixel] == 0.0F) ++zeros[(pixel / frame_columns + pixel % frame_columns) % 2];
  const auto [few, many] = std::minmax(zeros[0], zeros[1]);
  return many == frame_pixels / 2 && few < frame_pixels / 4;
}

std::span<const CameraProtocol> camera_protocols() {
  static const std::array table{gy_mcu90640_camera(), text_camera(), binary_camera(), i2c_stick_camera(),
                                mlx_raw_camera()};
  return table;
}

std::vector<std::string> camera_protocol_names() {
  return names_in(camera_protocols());
}

const CameraProtocol& camera_protocol(std::string_view name) {
  return required_in(camera_protocols(), name, "camera");
}

double latency_uncertainty_s(const CameraProfile& camera) {
  return thermorig::latency_uncertainty_s(camera, camera_protocol(camera.protocol).merges_halves);
}

CameraScanner camera_scanner(const CameraProfile& profile) {
  return camera_protocol(profile.protocol).scanner(profile);
}

}  // namespace thermorig::sensors

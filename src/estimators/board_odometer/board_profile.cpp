// SPDX-License-Identifier: MIT
#include "board_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/gyro_delay.h"

namespace thermorig::board_odometer {

namespace {

constexpr double narrowest_deg = 30.0, widest_deg = 115.0;
constexpr double slowest_hz = 0.5;
constexpr double waits_s = 0.3;  // a frame on its way, and the camera's latency
constexpr double least_scale_sigma = 0.002, least_latency_sigma_s = 0.002;

void require_room(const CameraProfile& camera) {
  if (camera.field_of_view_deg < narrowest_deg || camera.field_of_view_deg > widest_deg)
    throw Error(ExitCode::bad_usage, "the board's odometer has no room for this lens",
                fmt::format("camera.field_of_view_deg = {}", camera.field_of_view_deg), "30 to 115 degrees");
  if (camera.distortion != 0.0 || camera.tilt_deg != 0.0 || camera.roll_deg != 0.0 ||
      camera.row_spread != 0.0)
    throw Error(
        ExitCode::bad_usage, "the board's odometer knows a level lens without distortion, and no rows",
        fmt::format("camera.distortion = {}, tilt_deg = {}, roll_deg = {}, row_spread = {}",
                    camera.distortion, camera.tilt_deg, camera.roll_deg, camera.row_spread),
        "export with a copy of the profile in which these are 0: it keeps the pitch, and is less exact");
  if (camera.output_rate_hz < slowest_hz)
    throw Error(ExitCode::bad_usage, "the board's odometer does not remember the gyro for so long",
                fmt::format("camera.output_rate_hz = {}", camera.output_rate_hz),
                "0.5 frames a second or more");
}

}  // namespace

thermorig_odometer_profile board_profile(const RigProfile& rig) {
  const CameraProfile& camera = rig.camera;
  const GyroProfile& gyro = rig.gyro;
  require_room(camera);
  const double kept_s = 2.0 / camera.output_rate_hz + waits_s;
  thermorig_odometer_profile board{};
  board.pitch_deg =
      static_cast<float>(camera.field_of_view_deg * camera.pitch_scale / static_cast<double>(frame_columns));
  board.direction = camera.mirrored ? -1.0F : 1.0F;
  board.gyro_axis = gyro.axis;
  board.gyro_sign = gyro.sign;
  board.gyro_period_s = static_cast<float>(1.0 / gyro.output_rate_hz);
  board.gyro_time_sigma_s = static_cast<float>(time_uncertainty_s(gyro));
  board.bias_dps = static_cast<float>(gyro.bias_dps);
  board.bias_sigma_dps = static_cast<float>(gyro.later_bias_sigma_dps());
  board.scale = static_cast<float>(gyro.scale);
  board.scale_sigma = static_cast<float>(std::max(least_scale_sigma, gyro.scale_uncertainty));
  board.latency_sigma_s = static_cast<float>(
      std::hypot(least_latency_sigma_s, gyro.link.latency_uncertainty_s, camera.link.latency_uncertainty_s));
  board.knot_us = static_cast<std::uint32_t>(std::ceil(1e6 * kept_s / (THERMORIG_ODOMETER_KNOTS - 2)));
  return board;
}

}  // namespace thermorig::board_odometer

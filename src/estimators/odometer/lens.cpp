// SPDX-License-Identifier: MIT
#include "lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::odometer {

namespace {

constexpr double rad_a_deg = std::numbers::pi / 180.0;
constexpr double wide_deg = 80.0;  // MLX90640 data sheet: 55 x 35 degrees, and 110 x 75
constexpr double height_of_narrow = 35.0 / 55.0, height_of_wide = 75.0 / 110.0;
constexpr double least_spread = 0.02;  // of a period: below it rows may as well be exposed at once

}  // namespace

Lens::Lens(const CameraProfile& camera)
    : pitch_deg_(camera.field_of_view_deg * camera.pitch_scale / static_cast<double>(frame_columns)),
      direction_(camera.mirrored ? -1.0 : 1.0),
      is_plain_(camera.distortion == 0.0 && camera.tilt_deg == 0.0 && camera.roll_deg == 0.0),
      knows_rows_(std::abs(camera.row_spread) >= least_spread) {
  look(camera);
  look_by_columns();
  if (!knows_rows_) return;
  rows_ = camera.row_spread > 0.0 ? RowOrder::first_to_last : RowOrder::last_to_first;
  spread_ = std::abs(camera.row_spread);
}

/// A pixel's direction as a vector (ahead, to the side of growing azimuth, up), turned by roll and tilt.
void Lens::look(const CameraProfile& camera) {
  const double height = camera.field_of_view_deg > wide_deg ? height_of_wide : height_of_narrow;
  const double row_pitch_deg =
      pitch_deg_ * height * static_cast<double>(frame_columns) / static_cast<double>(frame_rows);
  const double roll = camera.roll_deg * rad_a_deg, tilt = camera.tilt_deg * rad_a_deg;
  constexpr double half_columns = 0.5 * frame_columns, half_rows_of_frame = 0.5 * frame_rows;
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t row = 0; row < frame_rows; ++row) {
      const double across = static_cast<double>(column) - 0.5 * (frame_columns - 1);
      const double below = static_cast<double>(row) - 0.5 * (frame_rows - 1);
      const double out = 0.5 * (square(across / half_columns) + square(below / half_rows_of_frame));
      const double wider = 1.0 + camera.distortion * out;
      const double side = direction_ * across * pitch_deg_ * wider * rad_a_deg;
      const double up = -below * row_pitch_deg * wider * rad_a_deg;
      const double y = std::cos(up) * std::sin(side), z = std::sin(up), x = std::cos(up) * std::cos(side);
      const double y_rolled = y * std::cos(roll) - z * std::sin(roll);
      const double z_rolled = y * std::sin(roll) + z * std::cos(roll);
      const double ahead = x * std::cos(tilt) - z_rolled * std::sin(tilt);
      const double above = x * std::sin(tilt) + z_rolled * std::cos(tilt);
      const double elevation_deg = std::asin(std::clamp(above, -1.0, 1.0)) / rad_a_deg - camera.tilt_deg;
      const std::size_t i = column * frame_rows + row;
      bearings_deg_[i] = static_cast<float>(std::atan2(y_rolled, ahead) / rad_a_deg);
      map_rows_[i] = static_cast<float>(0.5 * (frame_rows - 1) - elevation_deg / row_pitch_deg);
    }
}

void Lens::look_by_columns() {
  for (std::size_t column = 0; column < frame_columns; ++column) {
    columns_deg_[column] =
        direction_ * pitch_deg_ * (static_cast<double>(column) - 0.5 * (frame_columns - 1));
    if (is_plain_) continue;
    double sum_deg = 0.0;
    for (std::size_t row = 0; row < frame_rows; ++row) sum_deg += bearing_deg(column, row);
    columns_deg_[column] = sum_deg / static_cast<double>(frame_rows);
  }
}

}  // namespace thermorig::odometer

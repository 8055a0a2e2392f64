// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/simulation/panorama.h"

namespace thermorig::simulation {

/// A value for each pixel, column after column (32, 24): neighbours in a column share one azimuth, so that
/// the inner loops run over rows without a stride.
using PixelColumns = std::array<float, frame_pixels>;

constexpr std::size_t column_index(std::size_t row, std::size_t column) {
  return column * frame_rows + row;
}

/// What the lens shows of a panorama. MLX90640 data sheet: 55 x 35 deg (BAB) and 110 x 75 deg (BAA).
struct FieldOfView {
  double width_deg = 55.0;
  double height_deg = 35.0;

  /// The lens of that width: a width above 80 deg has the proportions of the wide lens.
  static FieldOfView of_width(double width_deg);
  double column_pitch_deg() const { return width_deg / frame_columns; }
  double row_pitch_deg() const { return height_deg / frame_rows; }
};

/// At every azimuth of the panorama, what a pixel sees that looks toward this elevation: blurred by its
/// response and the lens's.
std::vector<double> blurred_row(const Panorama& panorama, const FieldOfView& view, double elevation_deg);

/// Middles of rows and columns. Row 0 is the top, azimuths grow to the right.
double row_elevation_deg(const FieldOfView& view, std::size_t row);
double column_azimuth_deg(const FieldOfView& view, bool mirrored, std::size_t column);

/// The panorama as the 24 rows of pixels see it, blurred by the pixels' response once and for all: a view is
/// then a linear interpolation in azimuth.
class Optics {
 public:
  /// `mirrored`: columns run from right to left, as the GY-MCU90640 sends them.
  Optics(const Panorama& panorama, const FieldOfView& view, bool mirrored);

  /// What each pixel sees, in degrees Celsius, when the camera looks toward `yaw_deg` (any value, to the
  /// right is positive).
  void view(double yaw_deg, PixelColumns& temp_c) const;

 private:
  std::vector<float> strip_c_;                            // (1441, 24), the last azimuth repeats the first
  std::array<double, frame_columns> column_azimuth_deg_;  // relative to the optical axis
};

}  // namespace thermorig::simulation

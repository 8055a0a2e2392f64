// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "draw.h"
#include "thermorig/core/frame.h"
#include "thermorig/network/camera_view.h"

namespace thermorig::training {

/// The vertical part of a field of view over the horizontal one: 35 of 55 and 75 of 110 degrees.
inline constexpr double view_height_of_width = 0.65;

/// Temperatures all around, which nobody has measured: what a room may look like to a thermal camera.
class MadePanorama {
 public:
  static constexpr int columns = 720;  // of a whole turn
  static constexpr int rows = 80;      // 1.7 times the view's height, so that a tilted camera sees no edge
  static constexpr double column_deg = 360.0 / columns;
  using Values = std::vector<float>;  // (rows, columns), upwards, K

  static double row_deg(double view_width_deg) { return view_width_deg * view_height_of_width * 1.7 / rows; }

  /// Textures that panoramas share: each of mean 0 and deviation 1, alike on all scales.
  static std::vector<Values> textures(std::uint64_t seed, std::uint64_t block);
  static constexpr std::uint64_t textures_a_block = 16;

  MadePanorama(Draw& draw, const std::vector<Values>& textures, double view_width_deg);

  /// Mean of a row between two azimuths in columns, first < last, anywhere on the number line.
  float mean(int row, float first, float last) const {
    const float* const sums = sums_.data() + static_cast<std::size_t>(row) * (columns + 1);
    return (sum_to(sums, last) - sum_to(sums, first)) / (last - first);
  }

 private:
  static float sum_to(const float* sums, float column) {
    const int whole = static_cast<int>(column + 16.0F * columns) - 16 * columns;  // rounded down
    const int turn = (whole + 16 * columns) / columns - 16;
    const auto place = static_cast<std::size_t>(whole - turn * columns);
    const float part = column - static_cast<float>(whole);
    return static_cast<float>(turn) * sums[columns] + sums[place] + part * (sums[place + 1] - sums[place]);
  }

  Values sums_;  // (rows, columns + 1): running sums along the rows
};

/// A camera of a type, as one of them may be: its lens, its noise, its pixels.
struct MadeCamera {
  MadeCamera(Draw& draw, const network::CameraView& view);

  std::array<float, frame_pixels> column{};  // where a pixel looks, in columns of a panorama from the axis on
  std::array<std::uint8_t, frame_pixels> row{};  // of the panorama
  std::array<float, frame_pixels> noise_c{};     // one standard deviation
  std::array<float, frame_pixels> pattern_c{};   // what each pixel shows too much
  double half_offset_c = 0.0;                    // one standard deviation of what a whole half shows too much
  double lag_s = 0.0;                            // of the membranes
};

}  // namespace thermorig::training

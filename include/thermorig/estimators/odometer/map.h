// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/core/profile.h"

namespace thermorig::odometer {

/// In which order a camera exposes its rows: all at once, or one after the other over a refresh period, from
/// the first or from the last on.
enum class RowOrder : std::uint8_t { at_once, first_to_last, last_to_first };

/// In words: "read all at once".
constexpr std::string_view name_of(RowOrder order) {
  constexpr std::array<std::string_view, 3> names{"read all at once", "read from the first to the last",
                                                  "read from the last to the first"};
  return names[static_cast<std::size_t>(order)];
}

/// What the images of a start have told of that order.
struct FoundRows {
  RowOrder order = RowOrder::at_once;
  double margin = 0.0;  // logarithm of its likelihood over that of the best other order

  /// Below it the images have not told: rows are taken at once.
  static constexpr double least_margin = 10.0;
  bool operator==(const FoundRows&) const = default;
};

/// Surroundings as an odometer has seen them, and the pixels that saw them: another one that begins with them
/// tells where the camera looks in them. Whoever fills it from a file checks it first (estimators/map_file).
struct Map {
  static constexpr std::size_t bins = 420;  // equal parts of a whole turn, from the origin on
  static constexpr std::size_t nodes = 24;
  static constexpr std::size_t values = bins * frame_rows;

  /// What the camera that made it looked through, as its profile had it.
  struct Lens {
    Lens() = default;
    explicit Lens(const CameraProfile& camera)
        : field_of_view_deg(camera.field_of_view_deg * camera.pitch_scale),
          mirrored(camera.mirrored),
          distortion(camera.distortion),
          tilt_deg(camera.tilt_deg),
          roll_deg(camera.roll_deg) {}
    /// Columns stand upright and even, rows lie level.
    bool is_plain() const { return distortion == 0.0 && tilt_deg == 0.0 && roll_deg == 0.0; }

    double field_of_view_deg = 55.0;
    bool mirrored = true;  // order of the columns
    double distortion = 0.0, tilt_deg = 0.0, roll_deg = 0.0;
  };
  Lens lens;
  RowOrder rows = RowOrder::at_once;
  float reference_c = 0.0F;  // temperatures are differences from it
  // Bin after bin, of each the even rows from the top, then the odd ones.
  std::vector<float> temp_k = std::vector<float>(values);
  std::vector<float> variance_k2 = std::vector<float>(values);
  std::vector<std::uint8_t> seen = std::vector<std::uint8_t>(values);  // 1: once at least
  // By how much the map is off at nodes 15 degrees apart, and the lower triangle, row after row, of a matrix
  // that times its transpose is their covariance.
  std::array<double, nodes> offset_deg{};
  std::array<double, nodes*(nodes + 1) / 2> offset_root_deg{};
  std::array<std::uint8_t, nodes> offset_known{};  // 0 never seen, 1 what lies beside it, 2 seen
  // Of each pixel of the camera: even chess half, then odd one, column after column.
  std::array<float, frame_pixels> pixel_offset_k{}, pixel_variance_k2{};
};

/// What has become of the map that an odometer began with.
enum class MapUse : std::uint8_t {
  none,       // it began without one
  searching,  // where the camera looks in it is not known yet
  found,      // it is: headings are since its origin
  other       // what the camera shows does not fit it: a new map was begun
};

}  // namespace thermorig::odometer

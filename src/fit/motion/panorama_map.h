// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pixel_model.h"

namespace thermorig::motion {

/// The surroundings as the camera's 24 rows see them, in bins of azimuth: what all halves together say.
/// Values lie in cells: the 12 rows of one bin that one column of a half-frame can fill, side by side.
class PanoramaMap {
 public:
  using Cells = std::vector<float, Eigen::aligned_allocator<float>>;

  /// `closed`: azimuths wrap after 360 deg; else the map runs from `lowest_deg` over `span_deg`.
  PanoramaMap(double bin_deg, bool closed, double lowest_deg, double span_deg);

  /// Where the columns of a half lie, each between two cells: the first of their 12 values.
  struct Place {
    std::array<std::uint32_t, frame_columns> left;
    std::array<std::uint32_t, frame_columns> right;
    std::array<float, frame_columns> part;  // 0 at left, 1 at right
  };
  Place place(double angle_deg, double pitch_deg, bool mirrored, unsigned parity) const;

  /// The same of one column.
  struct Between {
    std::size_t left;
    std::size_t right;
    float part;
  };
  static Between between(const Place& place, std::size_t column) {
    return {place.left[column], place.right[column], place.part[column]};
  }
  /// The values of a cell, of `values` for each cell of the map.
  static ColumnOf at(Cells& values, std::size_t cell) { return ColumnOf(&values[cell]); }
  static ConstColumnOf at(const Cells& values, std::size_t cell) { return ConstColumnOf(&values[cell]); }

  void clear();
  void add(const Place& place, const HalfPixels& values, const HalfPixels& weights);
  /// Means and slopes of what was added.
  void finish();

  /// What a column there should read, its slope by azimuth (K a deg), and 1 where both are known, else 0.
  ColumnPixels mean(const Between& between) const {
    return at(mean_, between.left) + between.part * at(rise_, between.left);
  }
  ColumnPixels slope(const Between& between) const {
    const auto left = at(slope_, between.left);
    return left + between.part * (at(slope_, between.right) - left);
  }
  ConstColumnOf known(const Between& between) const { return at(both_known_, between.left); }

  /// How many values were needed to explain what was added.
  double parameters() const;

  std::size_t size() const { return weight_.size(); }
  double bin_deg() const { return bin_deg_; }
  const Cells& weight() const { return weight_; }
  /// Mean over the known cells of the slope squared, and of what noise of that variance adds to it.
  double slope_squared() const;
  double slope_noise(double noise_variance) const;

 private:
  std::uint32_t neighbour(std::uint32_t bin, int step) const;
  template <typename Look>
  void look_aside(Look look);
  void find_known();
  void find_means();
  void find_slopes();
  void find_rises();

  double bin_deg_;
  double lowest_deg_;
  bool closed_;
  std::uint32_t bins_;
  Cells weight_;
  Cells sum_;
  Cells reach_;  // weighted sum of how far readings lie right of the bin's middle, in bins
  Cells mean_;
  Cells slope_;
  Cells known_;
  // From a cell to the one on its right: found once, not for each column that lies between.
  Cells rise_;        // of the mean
  Cells both_known_;  // 1 or 0
};

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "column_pixels.h"

namespace thermorig::motion {

/// The surroundings as the camera's 24 rows see them, in bins of azimuth: what all halves together say.
/// Values lie in cells: the 12 rows of one bin that one column of a chess half can fill, side by side.
class PanoramaMap {
 public:
  /// `closed`: azimuths wrap after 360 deg; else the map runs from `lowest_deg` over `span_deg`.
  PanoramaMap(double bin_deg, bool closed, double lowest_deg, double span_deg);

  /// Where the columns of a half lie: between the middles of bins `left` and `right`.
  struct Place {
    std::array<std::uint32_t, frame_columns> left{};
    std::array<std::uint32_t, frame_columns> right{};
    std::array<float, frame_columns> part{};  // 0 at left, 1 at right
  };
  Place place(double angle_deg, double pitch_deg, bool mirrored) const;

  /// The same of one column: the first of the 12 values of the cells on either side.
  struct Between {
    std::size_t left;
    std::size_t right;
    float part;
  };
  static Between between(const Place& place, std::size_t column, unsigned parity) {
    return {cell(place.left[column], column, parity), cell(place.right[column], column, parity),
            place.part[column]};
  }
  /// The values of a cell, of `values` for each cell of the map.
  static Eigen::Map<ColumnPixels> at(std::vector<float>& values, std::size_t cell) {
    return Eigen::Map<ColumnPixels>(&values[cell]);
  }
  static Eigen::Map<const ColumnPixels> at(const std::vector<float>& values, std::size_t cell) {
    return Eigen::Map<const ColumnPixels>(&values[cell]);
  }

  void clear();
  void add(const Between& between, const ColumnPixels& value, const ColumnPixels& weight);
  /// Means and slopes of what was added.
  void finish();

  /// What a column there should read, its slope by azimuth (K a deg), and 1 where both are known, else 0.
  ColumnPixels mean(const Between& between) const { return interpolated(mean_, between); }
  ColumnPixels slope(const Between& between) const { return interpolated(slope_, between); }
  ColumnPixels known(const Between& between) const {
    return at(known_, between.left) * at(known_, between.right);
  }

  /// How many values were needed to explain what was added.
  double freedom() const;

  std::size_t size() const { return weight_.size(); }
  double bin_deg() const { return bin_deg_; }
  const std::vector<float>& weight() const { return weight_; }
  /// Mean over the known cells of the slope squared, and of what noise of that variance adds to it.
  double slope_squared() const;
  double slope_noise(double noise_variance) const;

 private:
  static std::size_t cell(std::uint32_t bin, std::size_t column, unsigned parity) {
    return (std::size_t{bin} * 2 + ((column ^ parity) & 1U)) * half_rows;
  }
  static ColumnPixels interpolated(const std::vector<float>& values, const Between& between) {
    const auto left = at(values, between.left);
    return left + between.part * (at(values, between.right) - left);
  }
  std::uint32_t neighbour(std::uint32_t bin, int step) const;
  void find_slopes();

  double bin_deg_;
  double lowest_deg_;
  bool closed_;
  std::uint32_t bins_;
  std::vector<float> weight_;
  std::vector<float> sum_;
  std::vector<float> reach_;  // weighted sum of how far readings lie right of the bin's middle, in bins
  std::vector<float> mean_;
  std::vector<float> slope_;
  std::vector<float> known_;
};

inline void PanoramaMap::add(const Between& between, const ColumnPixels& value, const ColumnPixels& weight) {
  const auto& [left, right, part] = between;
  const ColumnPixels to_right = part * weight;
  const ColumnPixels to_left = weight - to_right;
  at(weight_, left) += to_left;
  at(reach_, left) += to_left * part;
  at(sum_, left) += to_left * value;
  at(weight_, right) += to_right;
  at(reach_, right) += to_right * (part - 1.0F);
  at(sum_, right) += to_right * value;
}

}  // namespace thermorig::motion

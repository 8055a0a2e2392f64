// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "half_view.h"

namespace thermorig::motion {

/// The surroundings as the camera's 24 rows see them, in bins of azimuth: what all halves together say.
/// Values lie in cells: the 12 rows of one bin that one column of a chess half can fill, side by side.
class PanoramaMap {
 public:
  using Cell = Eigen::Array<float, half_rows, 1>;

  /// `closed`: azimuths wrap after 360 deg; else the map runs from `lowest_deg` over `span_deg`.
  PanoramaMap(double bin_deg, bool closed, double lowest_deg, double span_deg);

  /// Where the columns of a half lie: between the middles of bins `left` and `right`.
  struct Place {
    std::array<std::uint32_t, frame_columns> left{};
    std::array<std::uint32_t, frame_columns> right{};
    std::array<float, frame_columns> part{};  // 0 at left, 1 at right
  };
  Place place(double angle_deg, double pitch_deg, bool mirrored) const;

  /// Index of the first of the 12 values of a column's cell.
  static std::size_t cell(std::uint32_t bin, std::size_t column, unsigned parity) {
    return (std::size_t{bin} * 2 + ((column ^ parity) & 1U)) * half_rows;
  }

  void clear();
  void add(const Place& place, unsigned parity, const HalfPixels& value, const HalfPixels& weight);
  /// Means and slopes of what was added.
  void finish();

  /// What a half at that place should read: its mean, its slope by azimuth (K a deg), and 1 where both are
  /// known, else 0.
  struct Expected {
    HalfPixels mean{};
    HalfPixels slope{};
    HalfPixels known{};
  };
  void expect(const Place& place, unsigned parity, Expected& expected) const;
  /// The same without slopes.
  void expect_means(const Place& place, unsigned parity, Expected& expected) const;

  /// How many values were needed to explain what was added.
  double freedom() const;

  std::size_t size() const { return weight_.size(); }
  double bin_deg() const { return bin_deg_; }
  const std::vector<float>& weight() const { return weight_; }
  /// Mean over the known cells of the slope squared, and of what noise of that variance adds to it.
  double slope_squared() const;
  double slope_noise(double noise_variance) const;

 private:
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

}  // namespace thermorig::motion

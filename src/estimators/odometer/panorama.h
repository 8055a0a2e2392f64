// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "row_sums.h"
#include "sweep_ends.h"
#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// The surroundings all around the shaft, as the camera's 24 rows see them: a temperature and its variance in
/// each bin of azimuth. Those of one half's column lie side by side.
class Panorama {
 public:
  static constexpr std::size_t bins = Map::bins;
  static constexpr double bin_deg = whole_turn_deg / bins;

  Panorama();
  /// `rows_look_apart`: it is looked at row by row from now on, else column by column.
  /// `things_move`: what is far from what was seen before is hardly written, as long as it does not stay.
  void clear(bool rows_look_apart = false, bool things_move = false);
  void expect_traffic() { things_move_ = true; }

  /// Where one column of pixels looks while it is exposed: bins from the map's origin.
  struct Place {
    double middle = 0.0;
    double half_width = 0.5;  // at least 0.5
    std::size_t row_class = 0;
  };
  static Place place(double azimuth_deg, double half_width_deg, std::size_t row_class) {
    constexpr double widest = 0.25 * static_cast<double>(bins);
    return {share_of_turn(azimuth_deg) * static_cast<double>(bins),
            std::clamp(half_width_deg * (1.0 / bin_deg), 0.5, widest), row_class};
  }

  using Column = std::array<float, half_rows>;
  /// What the column should show: the mean over the bins that it sweeps.
  struct Slopes {
    Column slope, variance;  // by azimuth, K a deg
  };
  struct Look {
    Column temp_c;
    Column variance;  // of that mean
    Slopes of_azimuth;
    Column known;  // 1 where all of it was seen before, else 0
  };
  /// `reach`: bins to either side over which a slope is taken; `smooth`: over three rows.
  void look(const Place& place, std::ptrdiff_t reach, bool smooth, Look& look) const;
  /// The same of its k-th pixel alone, which looks where no other does: the rest of `look` stays as it is.
  /// Only where rows look apart, as all of `_row`.
  void look_row(const Place& place, std::size_t k, std::ptrdiff_t reach, bool smooth, Look& look) const;

  /// All of it but the slopes.
  void look_at_mean(const Place& place, std::ptrdiff_t reach, Look& look) const;
  void look_at_mean_row(const Place& place, std::size_t k, std::ptrdiff_t reach, Look& look) const;

  /// The mean, and whether it is known, alone.
  void look(const Place& place, Column& temp_c, Column& known) const;
  void look_row(const Place& place, std::size_t k, Column& temp_c, Column& known) const;

  /// What one column lets expect of the bins around its middle.
  struct Guess {
    double low = 0.0, high = 0.0;  // bins from there to there
    Column temp_c{};               // NaN: no reading
    Column slope{};                // by azimuth, K a deg
    Column variance{};
  };
  /// Bins that nothing has seen yet begin with it.
  void seed(const Place& place, const Guess& guess);
  void seed_row(const Place& place, std::size_t k, const Guess& guess);

  /// A Kalman filter a bin. NaN: no reading.
  void write(const Place& place, const Column& temp_c, const Column& variance);
  void write_row(const Place& place, std::size_t k, const Column& temp_c, const Column& variance);

  /// After writing, before looking.
  void add_up();

  /// Its temperatures as an image: frame_rows rows from the top, each of `bins`. NaN: never seen.
  std::vector<float> image() const;

  void keep(Map& map) const;
  void load(const Map& map);

 private:
  static constexpr std::size_t cell = half_rows;
  static std::size_t index(std::size_t bin, std::size_t row_class) { return (bin * 2 + row_class) * cell; }
  using Sums = std::vector<float>;
  void add_up(const std::vector<float>& values, Sums& sums) const;
  void note_change(std::ptrdiff_t from, std::ptrdiff_t to);
  static SweepEnds ends(const Place& place, std::ptrdiff_t reach) {
    return {place.middle - place.half_width, place.middle + place.half_width, reach};
  }
  static void sum_between(const Sums& sums, const BinPosition& from, const BinPosition& to,
                          std::size_t row_class, Column& sum);
  void look_slope(const Place& place, const SweepEnds& ends, std::size_t row_class, std::ptrdiff_t reach,
                  Slopes& slopes) const;
  void look_at_mean(const Place& place, const SweepEnds& ends, std::ptrdiff_t reach, Look& look) const;
  struct Slope {
    float slope, variance;
  };
  Slope slope_of_row(std::size_t row, const SweepEnds& ends, float scale) const;
  void look_at_mean_row(const Place& place, const SweepEnds& ends, std::size_t k, std::ptrdiff_t reach,
                        Look& look) const;
  // Of a column's pixels so many from the k-th on: all of them, or one.
  template <std::size_t pixels>
  void seed_pixels(const Place& place, std::size_t first, const Guess& guess);
  template <std::size_t pixels>
  void write_pixels(const Place& place, std::size_t first, const Column& temp_c, const Column& variance);

  bool rows_look_apart_ = false, things_move_ = false;
  std::vector<float> temp_c_, variance_, seen_;  // of each bin
  Sums temp_sum_, variance_sum_, seen_sum_;      // of all bins before
  RowSums row_sums_;                             // instead of these, where rows look apart
  std::size_t changed_from_ = 0;                 // bins before it are added up as they are
};

}  // namespace thermorig::odometer

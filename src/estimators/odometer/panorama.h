// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

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
  /// `things_move`: what is far from what was seen before is hardly written, as long as it does not stay.
  void clear(bool things_move = false);
  void expect_traffic() { things_move_ = true; }

  /// Where pixels of one column look while they are exposed: all of its rows, or one row by itself.
  struct Ray {
    double middle = 0.0;      // bins from the map's origin
    double half_width = 0.5;  // at least 0.5
    std::size_t row_class = 0;
    std::size_t k = 0;  // of the first of its pixels, in their column
    bool is_of_one = false;
  };
  static Ray of_column(double azimuth_deg, double half_width_deg, std::size_t row_class) {
    constexpr double widest = 0.25 * static_cast<double>(bins);
    return {.middle = share_of_turn(azimuth_deg) * static_cast<double>(bins),
            .half_width = std::clamp(half_width_deg * (1.0 / bin_deg), 0.5, widest),
            .row_class = row_class};
  }
  /// `row`: of the frame.
  static Ray of_pixel(double azimuth_deg, double half_width_deg, std::size_t row) {
    Ray ray = of_column(azimuth_deg, half_width_deg, row % 2);
    ray.k = row / 2;
    ray.is_of_one = true;
    return ray;
  }

  using Column = std::array<float, half_rows>;
  /// What the pixels should show: the mean over the bins that they sweep.
  struct Slopes {
    Column slope, variance;  // by azimuth, K a deg
  };
  struct Predicted {
    Column temp_c;
    Column variance;  // of that mean
    Slopes of_azimuth;
    Column known;  // 1 where all of it was seen before, else 0
  };
  /// Of the ray's pixels; the rest of `predicted` stays as it is. `reach`: bins to either side over which a
  /// slope is taken; `smooth`: over three rows.
  void predict(const Ray& ray, std::ptrdiff_t reach, bool smooth, Predicted& predicted) const;
  /// All of it but the slopes.
  void predict_mean(const Ray& ray, std::ptrdiff_t reach, Predicted& predicted) const;
  /// The mean, and whether it is known, alone.
  void predict(const Ray& ray, Column& temp_c, Column& known) const;

  /// What one column lets expect of the bins around its middle.
  struct Guess {
    double low = 0.0, high = 0.0;  // bins from there to there
    Column temp_c{};               // NaN: no reading
    Column slope{};                // by azimuth, K a deg
    Column variance{};
  };
  /// Bins that nothing has seen yet begin with it.
  void seed(const Ray& ray, const Guess& guess);
  /// A Kalman filter a bin. NaN: no reading.
  void write(const Ray& ray, const Column& temp_c, const Column& variance);
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

  // Of so many pixels of a column from the k-th on: all of them, or one.
  template <std::size_t pixels>
  using Pixels = std::array<float, pixels>;
  struct SweepEnds;
  template <std::size_t pixels>
  void predict_mean(const Ray& ray, const SweepEnds& at, std::ptrdiff_t reach, Predicted& predicted) const;
  template <std::size_t pixels>
  void predict_of(const Ray& ray, std::ptrdiff_t reach, bool smooth, Predicted& predicted) const;
  template <std::size_t pixels>
  void predict_of(const Ray& ray, Column& temp_c, Column& known) const;
  template <std::size_t pixels>
  void find_slopes(const SweepEnds& at, std::size_t first, float scale, float* slope, float* variance) const;
  template <std::size_t pixels>
  void seed_of(const Ray& ray, const Guess& guess);
  template <std::size_t pixels>
  void write_of(const Ray& ray, const Column& temp_c, const Column& variance);

  bool things_move_ = false;
  std::vector<float> temp_c_, variance_, seen_;  // of each bin
  Sums temp_sum_, variance_sum_, seen_sum_;      // of all bins before
  std::size_t changed_from_ = 0;                 // bins before it are added up as they are
};

}  // namespace thermorig::odometer

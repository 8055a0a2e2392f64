// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "gyro_path.h"
#include "half_store.h"
#include "heading_filter.h"
#include "lens.h"

namespace thermorig::odometer {

/// How likely a bias is before anything was seen, by how far it is off the expected one: Cauchy's density,
/// without its factor. A profile may be of another day or of another gyro: no bias is ruled out.
inline double bias_before(double off_dps, const Priors& priors) {
  return 1.0 / (1.0 + square(off_dps / priors.bias_sigma_dps));
}

/// The gyro's bias from the first seconds, moving or not: of all biases that the gyro may have, the one with
/// which its halves make the sharpest mosaic.
class BiasSearch {
 public:
  BiasSearch(const Priors& priors, const SharedLens& lens);

  /// The mosaics that biases make, a step apart; the middle one by the bias that was expected.
  struct Curve {
    std::span<const double> variances;  // valid until the next search
    double step_dps = 0.0;
    double read_dps = 0.0;     // by the gyro, on average
    double least = 0.0;        // of the variances
    double readings = 0.0;     // of a mosaic
    double trusted = 0.0;      // of its likelihood, where this search alone names a bias
    bool is_distinct = false;  // noise alone would not make the variances differ by so much

    double likelihood(std::size_t place, double trust) const {
      return std::exp(-trust * readings * (variances[place] / least - 1.0));
    }
  };
  /// By so many halves of the store, the last ones, if rows are exposed in that order. There must be so many.
  Curve measure(const HalfStore& store, const GyroPath& path, RowOrder rows, bool things_move);

  struct Found {
    double bias_dps = 0.0, sigma_dps = 0.0;
  };
  /// Nothing: it does not tell yet.
  std::optional<Found> named(const Curve& curve) const;
  /// Measures, and names what it finds; nothing where there are too few halves, too.
  std::optional<Found> search(const HalfStore& store, const GyroPath& path, RowOrder rows = RowOrder::at_once,
                              bool things_move = false);

  static constexpr std::size_t halves = 24;
  // Of a mosaic's likelihood. Where the order of rows is known nobody waits for the biases of wrong orders.
  // Of 1119 searches on ten rigs 87 % named one with 0.3, half of them within 3 deg/s of it; with 0.03 it is
  // 25 %, and 79 % of them. Where things move, a mosaic is even less to be trusted.
  static constexpr double trusted_with_care = 0.03;
  static constexpr std::size_t most_steps = 121;

 private:
  // Columns. Where rows are exposed in turn each pixel has a cell of its own to find: every second one of a
  // half's row is looked at, which begins in the first column or the one after it.
  static constexpr std::size_t row_stride = 4, looks_a_row = frame_columns / row_stride;

  void place(const HalfStore& store, const GyroPath& path);
  void take_off_pixel_errors();
  void clip();
  double read_dps() const;

  struct Placed {
    HalfPixels temp_c{};   // without what it has in common, and without what its pixels always have
    HalfPixels is_read{};  // 1, or 0 where there is no reading; `temp_c` is 0 there
    unsigned parity = 0;
    ExposedTurn turn;
    std::array<double, frame_rows> later_s{}, later_deg{};  // of a row: than the middle ones
  };
  /// Of all rows of a frame that one column of a chess half has: what was read at one azimuth.
  struct Cells {
    std::array<float, half_rows> sum{}, count{};
  };
  /// What one row of a half read, in every second of its pixels, and where it looked.
  struct RowReadings {
    std::array<float, looks_a_row> temp_c{}, is_read{}, bearing_cells{};
    double later_s = 0.0, later_deg = 0.0;  // than the middle of the first half
  };
  /// Squares of the means of its cells, each as often as there are readings, and how many cells hold any.
  struct Mosaic {
    double of_means = 0.0, used = 0.0;
  };
  template <std::size_t lanes>
  struct MosaicSums;
  struct Biases {
    double first_dps = 0.0, step_dps = 0.0;
    std::size_t count = 0;
    double dps(std::size_t place) const { return first_dps + static_cast<double>(place) * step_dps; }
  };
  Biases biases_that_may_be() const;
  float cell_of(double azimuth_deg) const;
  int index_of(float cell) const;
  void note_readings();
  void add_columns(const Placed& one, double turned_deg);
  Mosaic mosaic_with(double bias_dps);
  void add_row(std::size_t row, const Biases& biases);
  void gather_row(std::size_t row);
  Mosaic row_mosaic_with(double bias_dps);
  double variance(const Mosaic& mosaic) const;

  RowOrder rows_ = RowOrder::at_once;
  Priors priors_;
  SharedLens lens_;
  std::size_t cells_a_row_;
  std::vector<Placed> placed_;
  std::array<float, frame_columns> bearing_cells_{};  // of each column
  std::vector<Cells> cells_;                          // of each azimuth, for both classes of rows
  std::vector<RowReadings> row_readings_;             // of one row in all halves
  std::vector<float> row_sum_, row_count_;            // of that row, at each azimuth
  std::vector<Mosaic> mosaics_;                       // a bias each
  double squares_ = 0.0, readings_ = 0.0;             // of all that was placed
  std::vector<double> variances_, ordered_;           // a bias each
};

}  // namespace thermorig::odometer

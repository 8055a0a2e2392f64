// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "gyro_path.h"
#include "half_store.h"
#include "heading_filter.h"
#include "lens.h"

namespace thermorig::odometer {

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
    double readings = 0.0;     // that a mosaic counts as
    bool is_distinct = false;  // noise alone would not make the variances differ by so much

    double likelihood(std::size_t place) const {
      return std::exp(-readings * (variances[place] / least - 1.0));
    }
  };
  /// By so many halves of the store, the last ones, if rows are exposed in that order. There must be so many.
  Curve measure(const HalfStore& store, const GyroPath& path, RowOrder rows, bool things_move);

  struct Found {
    double bias_dps = 0.0, sigma_dps = 0.0;
  };
  /// Nothing: it does not tell yet.
  std::optional<Found> named(const Curve& curve) const;
  /// Both; nothing where there are too few halves, too.
  std::optional<Found> search(const HalfStore& store, const GyroPath& path, RowOrder rows = RowOrder::at_once,
                              bool things_move = false);

  static constexpr std::size_t halves = 24;
  static constexpr std::size_t most_steps = 121;

 private:
  void place(const HalfStore& store, const GyroPath& path);
  void take_off_pixel_errors();
  void clip();
  double variance_with(double bias_dps);
  double read_dps() const;

  struct Placed {
    HalfPixels temp_c{};  // without what it has in common, and without what its pixels always have
    unsigned parity = 0;
    ExposedTurn turn;
    std::array<double, frame_rows> later_s{}, later_deg{};  // of a row: than the middle ones
  };
  struct Cell {
    float sum = 0.0F, squares = 0.0F, count = 0.0F;
    void add(float temp_c);
  };
  Cell* cells_at(double azimuth_deg);
  void add_column(const Placed& one, std::size_t column, double turned_deg);
  void add_rows(const Placed& one, double turned_deg, double bias_dps);

  RowOrder rows_ = RowOrder::at_once;
  Priors priors_;
  SharedLens lens_;
  std::size_t cells_a_row_;
  std::vector<Placed> placed_;
  std::vector<Cell> cells_;
  std::vector<double> variances_, ordered_;  // a bias each
};

}  // namespace thermorig::odometer

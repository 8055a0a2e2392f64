// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "lens.h"
#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::odometer {

/// The halves of the start, to be gone through again: the first ones, as many as there is room for.
class HalfStore {
 public:
  HalfStore() : halves_(room) {}

  struct Stored {
    HalfFrame half;
    double now_s = 0.0;  // when it came
  };

  void add(const HalfFrame& half, double now_s) {
    if (count_ < room) halves_[count_++] = {half, now_s};
  }
  std::size_t count() const { return count_; }
  bool is_full() const { return count_ == room; }
  const Stored& at(std::size_t place) const { return halves_[place]; }
  void clear() { count_ = 0; }
  void forget(std::size_t first, std::size_t halves) {
    const auto to = halves_.begin() + static_cast<std::ptrdiff_t>(first);
    std::move(to + static_cast<std::ptrdiff_t>(halves), halves_.begin() + static_cast<std::ptrdiff_t>(count_),
              to);
    count_ -= halves;
  }

  static constexpr std::size_t room = 480;  // a minute at 8 halves a second

 private:
  std::vector<Stored> halves_;
  std::size_t count_ = 0;
};

/// What may be true of gyro and camera: half-frames are placed side by side with it.
struct Hypothesis {
  double bias_dps = 0.0, scale = 1.0, latency_s = 0.0;  // the gyro's, and the camera's against it
  RowOrder order = RowOrder::at_once;
};

/// The newest halves of a start, laid beside each other by what the gyro turned: the less the readings in a
/// cell differ, the better the gyro is known. Rows are in three bands, each with cells of its own; the middle
/// one's times hardly depend on the order in which rows are exposed.
class Mosaic {
 public:
  static constexpr std::size_t most_halves = 160, bands = 3, middle = bands / 2;

  explicit Mosaic(const SharedLens& lens);

  /// The newest halves of the store, instead of those before.
  void take(const HalfStore& store, const TurnPath& path);

  /// Of normal readings with an unknown variance in cells so many pixels wide, by the middle band or by all.
  /// It is to be trusted far less: halves are blurred, and what moves is in several.
  double log_likelihood(const Hypothesis& hypothesis, double cell_pixels);
  double log_likelihood_of_bands(const Hypothesis& hypothesis, double cell_pixels);

  std::size_t halves() const { return placed_.size(); }
  /// What log_likelihood() costs: pairs at a cell.
  std::size_t work() const { return placed_.size() * pairs; }
  double spanned_s() const;      // at least 1
  double turned_deg() const;     // between the outermost halves, by the gyro as it reads
  double mean_read_dps() const;  // from the first half to the last
  double period_s() const { return placed_.back().period_s; }  // of refresh

 private:
  // A pair: two columns of a half-frame, which have both classes of rows.
  static constexpr std::size_t pairs = frame_columns / 2, band_rows = half_rows / bands;
  using Pair = std::array<float, band_rows>;

  struct Band {
    std::array<Pair, pairs> temp_c{};  // without what all have in common; 0 where there is no reading
    std::array<float, pairs> is_read{};
  };
  struct Placed {
    std::array<Band, bands> of{};
    unsigned parity = 0;
    double period_s = 0.0, mean_s = 0.0, mean_deg = 0.0, read_dps = 0.0;
  };
  struct Cell {
    Pair sum{};
    float count = 0.0F;
  };
  struct Squares {
    double k2 = 0.0, readings = 0.0, cells = 0.0;

    double log_likelihood() const;
  };

  void place(const HalfFrame& half, const TurnPath& path);
  void clip(Band& band);
  void take_off_errors_of_pairs(std::size_t band);
  double band_delay_periods(RowOrder order, std::size_t band) const;
  void add_within_cells(const Hypothesis& hypothesis, std::size_t band, double cell_pixels, Squares& within);

  SharedLens lens_;
  std::array<float, pairs> bearing_turns_{};  // of each pair
  std::vector<Placed> placed_;
  std::vector<float> read_c_;       // of one band
  std::array<Squares, bands> all_;  // of all that was placed
  std::vector<Cell> cells_;
};

}  // namespace thermorig::odometer

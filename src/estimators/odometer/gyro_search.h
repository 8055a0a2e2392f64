// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "gyro_path.h"
#include "half_store.h"
#include "heading_filter.h"
#include "lens.h"

namespace thermorig::odometer {

inline constexpr double same_scale = 0.015;  // of one gyro, by two searches or by what was learnt

/// A gyro that searches name: its scale as well.
bool names_scale(const Priors& found);

/// The gyro's bias and scale, and in which order the camera exposes its rows, from up to twenty seconds of
/// halves at once: those with which they make the sharpest mosaic. The filter, begun with a wrong gyro, finds
/// a map for it. A mosaic needs no beginning: all biases and scales are looked at, in coarse steps first,
/// then in finer ones about the best; with that, all orders of rows.
class GyroSearch {
 public:
  /// `latency_measured`: the camera's times are those of its middle rows; else they may be those of the last.
  GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured);

  /// With each new half of the store: a step of bounded work. A search takes the newest halves, and ends up
  /// to a few seconds later; then another one begins.
  void add(const HalfStore& store, const GyroPath& path);
  /// What was expected, with a better bias and scale, by the last search that told. Nothing: none has. That
  /// of a rig that rests or turns at one speed tells the rate, and not what of it is bias and what scale.
  /// Where searches told the order of rows, the camera's latency with it as well.
  const std::optional<Priors>& found() const { return found_; }
  /// The order of rows that a search has told by the widest margin. Where a calibration knows it, that one.
  const FoundRows& rows() const { return rows_; }
  void clear();

  static constexpr std::size_t fewest_halves = 48, most_halves = 160, halves_between = 24;

 private:
  // A look: two columns of a chess half, which have both classes of rows. Rows are looked at in bands.
  static constexpr std::size_t looks = frame_columns / 2, bands = 3, band_rows = half_rows / bands;
  static constexpr std::size_t middle = bands / 2;  // its times hardly depend on the order of rows
  using Look = std::array<float, band_rows>;

  struct Band {
    std::array<Look, looks> temp_c{};  // without what all have in common; 0 where there is no reading
    std::array<float, looks> is_read{};
  };
  struct Placed {
    std::array<Band, bands> of{};
    unsigned parity = 0;
    double period_s = 0.0, mean_s = 0.0, mean_deg = 0.0, read_dps = 0.0;
  };
  struct Candidate {
    double bias_dps = 0.0, scale = 1.0, latency_s = 0.0;
    RowOrder order = RowOrder::at_once;
    double log_likelihood = 0.0;
  };
  struct Cell {
    Look sum{};
    float count = 0.0F;
  };
  struct Squares {
    double k2 = 0.0, readings = 0.0, cells = 0.0;
  };

  bool is_searching() const { return level_ <= order_level; }
  void begin(const HalfStore& store, const GyroPath& path);
  void place(const HalfReading& half, const GyroPath& path);
  double spanned_s() const;
  void clip(Band& band);
  void take_off_errors_of_looks(std::size_t band);
  void lay_grid();
  void go_on();
  void end_level();
  void refine();
  void lay_orders();
  void name();
  void name_rows();
  bool names_rate() const;
  void believe();
  double log_before(const Candidate& candidate) const;
  double log_likelihood(const Candidate& candidate);
  std::size_t cells_a_turn(double pitches) const;
  double band_delay_periods(RowOrder order, std::size_t band) const;
  void add_within_cells(const Candidate& candidate, std::size_t band, Squares& within);

  static constexpr int finest_level = 3, order_level = 4;

  Priors priors_;
  SharedLens lens_;
  bool latency_measured_;
  std::array<float, looks> bearing_turns_{};  // of each look
  std::vector<Placed> placed_;
  std::vector<float> read_c_;       // of one band
  std::array<Squares, bands> all_;  // of all that was placed
  std::vector<Cell> cells_;
  std::vector<Candidate> candidates_, best_;
  double step_dps_ = 0.0, scale_step_ = 0.0;
  std::size_t next_ = 0;         // of the candidates
  int level_ = order_level + 1;  // the first one in coarse cells; at the last one, orders of rows
  std::size_t new_halves_ = 0;   // since the last search began
  Priors named_;                 // by this search
  std::optional<Priors> found_, other_;
  FoundRows rows_;
};

}  // namespace thermorig::odometer

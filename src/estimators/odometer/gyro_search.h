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

/// The gyro's bias and scale from up to twenty seconds of halves at once: those with which they make the
/// sharpest mosaic. The filter, begun with a wrong gyro, finds a map for it. A mosaic needs no beginning: all
/// biases and scales are looked at, in coarse steps first, then in finer ones about the best.
class GyroSearch {
 public:
  /// `latency_measured`: the camera's times are those of its middle rows; else they may be those of the last.
  GyroSearch(const Priors& priors, const SharedLens& lens, bool latency_measured);

  /// With each new half of the store: a step of bounded work. A search takes the newest halves, and ends up
  /// to a few seconds later; then another one begins.
  void add(const HalfStore& store, const GyroPath& path);
  /// What was expected, with a better bias and scale, by the last search that told. Nothing: none has. That
  /// of a rig that rests or turns at one speed tells the rate, and not what of it is bias and what scale.
  const std::optional<Priors>& found() const { return found_; }
  void clear();

  static constexpr std::size_t fewest_halves = 48, most_halves = 160, halves_between = 24;

 private:
  // A look: two columns of a chess half, which have both classes of rows, and of those the middle ones, whose
  // times hardly depend on the order in which rows are exposed.
  static constexpr std::size_t looks = frame_columns / 2, rows = 4, first_row = (half_rows - rows) / 2;
  using Look = std::array<float, rows>;

  struct Placed {
    std::array<Look, looks> temp_c{};  // without what all have in common; 0 where there is no reading
    std::array<float, looks> is_read{};
    unsigned parity = 0;
    double mean_s = 0.0, mean_deg = 0.0, read_dps = 0.0;
  };
  struct Candidate {
    double bias_dps = 0.0, scale = 1.0, latency_s = 0.0;
    double log_likelihood = 0.0;
  };
  struct Cell {
    Look sum{};
    float count = 0.0F;
  };

  bool is_searching() const { return level_ < levels; }
  void begin(const HalfStore& store, const GyroPath& path);
  void place(const HalfReading& half, const GyroPath& path);
  double spanned_s() const;
  void clip(Placed& placed);
  void take_off_errors_of_looks();
  void lay_grid(double period_s);
  void go_on();
  void end_level();
  void refine();
  void name();
  void believe(const Priors& named);
  double log_before(const Candidate& candidate) const;
  double log_likelihood(const Candidate& candidate);
  std::size_t cells_a_turn(double pitches) const;
  double variance(const Candidate& candidate);

  static constexpr int levels = 4;

  Priors priors_;
  SharedLens lens_;
  bool latency_measured_;
  std::array<float, looks> bearing_turns_{};  // of each look
  std::vector<Placed> placed_;
  std::vector<float> read_c_;              // of one half
  double squares_ = 0.0, readings_ = 0.0;  // of all that was placed
  std::vector<Cell> cells_;
  std::vector<Candidate> candidates_, best_;
  double step_dps_ = 0.0, scale_step_ = 0.0;
  std::size_t next_ = 0;        // of the candidates
  int level_ = levels;          // the first one in coarse cells
  std::size_t new_halves_ = 0;  // since the last search began
  std::optional<Priors> found_, other_;
};

}  // namespace thermorig::odometer

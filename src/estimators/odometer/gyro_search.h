// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "heading_filter.h"
#include "lens.h"
#include "mosaic.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::odometer {

inline constexpr double same_scale = 0.015;  // of one gyro, by two searches or by what was learnt

/// Whether searches found the scale as well as the rate.
bool is_scale_known(const Priors& found);

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
  void add(const HalfStore& store, const TurnPath& path);
  /// What was expected, with the bias and scale that searches have confirmed. Nothing: none has yet. That
  /// of a rig that rests or turns at one speed knows the rate, and not what of it is bias and what scale.
  /// Where searches found the order of rows, the camera's latency with it as well.
  const std::optional<Priors>& found() const { return found_; }
  /// The order of rows that a search has found by the widest margin. Where a calibration knows it, that one.
  const FoundRows& rows() const { return rows_; }
  void clear();

  static constexpr std::size_t fewest_halves = 48, most_halves = Mosaic::most_halves, halves_between = 24;

 private:
  struct Candidate {
    Hypothesis hypothesis;
    double log_likelihood = 0.0;
  };

  bool is_searching() const { return level_ <= order_level; }
  void begin(const HalfStore& store, const TurnPath& path);
  void make_grid();
  void go_on();
  void end_level();
  void refine();
  const Candidate& best() const;
  void make_orders();
  void estimate_gyro();
  void estimate_rows();
  bool is_rate_known() const;
  void confirm();
  double log_before(const Hypothesis& hypothesis) const;
  double log_likelihood(const Hypothesis& hypothesis);

  static constexpr int finest_level = 3, order_level = 4;

  Priors priors_;
  SharedLens lens_;
  bool latency_measured_;
  Mosaic mosaic_;
  std::vector<Candidate> candidates_, best_;
  double step_dps_ = 0.0, scale_step_ = 0.0;
  std::size_t next_ = 0;         // of the candidates
  int level_ = order_level + 1;  // the first one in coarse cells; at the last one, orders of rows
  std::size_t new_halves_ = 0;   // since the last search began
  Priors estimate_;              // by this search
  std::optional<Priors> found_, rival_;
  FoundRows rows_;
};

}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "tracker.h"

namespace thermorig::odometer {

/// Mean normalised innovation squared (NIS) of late, a running mean: 1 where the filter knows how sure it is.
/// One half-frame counts with `most` at most.
inline constexpr double most_nis = 60.0;
inline void learn_nis(const HalfResult& result, double& mean, double most = most_nis) {
  constexpr double nis_share = 1.0 / 30.0;  // of a half in the mean of its kind
  if (result.is_judged) mean += nis_share * (std::min(most, result.nis) - mean);
}
inline constexpr double lost_nis = 8.0;  // then the heading is lost

/// What a mean NIS says. One half-frame counts with `most` at most.
struct NisBounds {
  double settled, fits, unfit, lost;  // not trusted from `unfit` on until it `fits`
  double most;
};
inline constexpr NisBounds nis_at_rest{2.0, 2.0, 3.0, lost_nis, most_nis};  // where nothing moves but the rig
// There the share of the halves counts that do not fit: how badly they do shows that something moves.
inline constexpr NisBounds nis_in_traffic{4.5, 4.0, 5.5, 7.0, 9.0};
constexpr const NisBounds& nis_bounds(bool things_move) {
  return things_move ? nis_in_traffic : nis_at_rest;
}

/// How large innovations are, of a pass through the halves of the start or of late: whether a map is a false
/// one, and whether something else than the rig moves.
class InnovationCount {
 public:
  void add(const HalfResult& result) {
    if (!result.is_judged) return;
    const bool is_far = std::abs(result.innovation_deg) > far_deg;
    ++judged_;
    if (is_far) ++far_;
    if (result.nis <= large_squares) return;
    ++large_;
    if (result.nis > huge_squares) ++huge_;
    if (is_far) ++large_and_far_;
    if (result.innovation_deg > 0.0) ++positive_;
    if (result.innovation_deg * result.rate_dps > 0.0) ++with_turn_;
  }

  /// What came long ago counts less.
  void forget_half() {
    for (int* one : {&judged_, &far_, &large_, &huge_, &large_and_far_, &positive_, &with_turn_}) *one /= 2;
  }
  int judged() const { return judged_; }

  /// Fewer than half of the `halves` of the pass could be compared with the map.
  bool is_hardly_judged(std::size_t halves) const { return 2 * static_cast<std::size_t>(judged_) < halves; }

  bool is_false_map() const { return far_ > most_far * judged_; }

  /// Some halves do not fit at all, while most do: something moves before some of them. Where a map or the
  /// order of rows is wrong, all fit badly, and of the large innovations few are huge.
  bool shows_traffic() const { return most_fit() && huge_ > least_huge * large_; }

  /// The same after the start, by a map that was right: what does not fit shows something else, and lies to
  /// both sides. A wrong bias puts it to one side, and wrong times to the one to which the rig turns, or to
  /// the other.
  bool shows_traffic_after_start() const {
    return most_fit() && large_ > least_large * judged_ && huge_ > least_huge_later * large_ &&
           large_and_far_ > least_far_later * large_ && !is_one_sided(positive_) && !is_one_sided(with_turn_);
  }

 private:
  static constexpr double far_deg = 4.0;    // the map shows something else there
  static constexpr double most_far = 0.25;  // share of the judged ones: false maps have far more
  static constexpr double large_squares = 4.0, huge_squares = 16.0;  // in units of what was expected
  static constexpr int fewest = 60;
  static constexpr double most_large = 0.35, least_huge = 0.38;  // shares: of the judged, of the large ones
  // The same after the start: of the judged ones, and of the large ones.
  static constexpr double least_large = 0.05, least_huge_later = 0.25, least_far_later = 0.15;
  static constexpr double most_to_one_side = 0.7;

  bool most_fit() const { return judged_ >= fewest && !is_false_map() && large_ < most_large * judged_; }
  bool is_one_sided(int count) const {
    return count > most_to_one_side * large_ || large_ - count > most_to_one_side * large_;
  }

  int judged_ = 0, far_ = 0, large_ = 0, huge_ = 0;
  int large_and_far_ = 0, positive_ = 0, with_turn_ = 0;  // of the large ones
};

/// The mean innovation of the last two seconds, with its sign: where it is far from zero, what was learnt of
/// the sensors is wrong.
class MeanInnovation {
 public:
  /// Of a rig that turns so fast by now.
  void begin(double rate_dps) {
    mean_ = 0.0;
    mean_rate_dps_ = rate_dps;
  }
  void add(const HalfResult& result) {
    mean_rate_dps_ += share * (result.rate_dps - mean_rate_dps_);
    mean_ += share * (std::copysign(std::sqrt(result.nis), result.innovation_deg) - mean_);
  }
  /// Something was done about it.
  void forget() { mean_ = 0.0; }

  bool is_one_sided(bool things_move) const {
    return std::abs(mean_) >= (things_move ? most_in_traffic : most);
  }
  /// The rig turned at another speed than now within the same time: what depends on the speed shows then.
  bool came_with_other_speed(double rate_dps) const {
    return std::abs(rate_dps - mean_rate_dps_) > other_speed_dps;
  }

 private:
  static constexpr double share = 1.0 / 16.0;
  static constexpr double most = 0.7, most_in_traffic = 1.0;  // innovations, in units of what was expected
  static constexpr double other_speed_dps = 10.0;

  double mean_ = 0.0;  // with their signs
  double mean_rate_dps_ = 0.0;
};

}  // namespace thermorig::odometer

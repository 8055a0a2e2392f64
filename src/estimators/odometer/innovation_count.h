// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "tracker.h"

namespace thermorig::odometer {

/// How large innovations are, of a pass through the halves of the start or of late: whether a map is a false
/// one, and whether something else than the rig moves.
class InnovationCount {
 public:
  void add(const HalfResult& result) {
    if (!result.is_judged) return;
    const bool is_far = std::abs(result.innovation_deg) > far_deg;
    ++judged_;
    if (is_far) ++far_;
    if (result.squared <= large_squares) return;
    ++large_;
    if (result.squared > huge_squares) ++huge_;
    if (is_far) ++large_and_far_;
    if (result.innovation_deg > 0.0) ++positive_;
    if (result.innovation_deg * result.rate_dps > 0.0) ++with_turn_;
  }

  /// What came long ago counts less.
  void forget_half() {
    for (int* one : {&judged_, &far_, &large_, &huge_, &large_and_far_, &positive_, &with_turn_}) *one /= 2;
  }
  int judged() const { return judged_; }

  /// Fewer than half of the `halves` of the pass could be laid against the map.
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
  static constexpr double far_deg = 4.0;  // the map shows something else there
  // False maps have 40 to 70 %, sound ones 3 to 15, up to 23 in slow starts.
  static constexpr double most_far = 0.25;
  static constexpr double large_squares = 4.0, huge_squares = 16.0;  // in units of what was expected
  static constexpr int fewest = 60;
  // With a person 10 to 32 % are large, and of these 40 to 70 % huge; without, 20 to 32 % are.
  static constexpr double most_large = 0.35, least_huge = 0.38;
  // Of the judged ones, and of the large ones. Of 18 test rooms that someone walked into, five are tracked
  // for longer with it, by 2 to 21 % of the time; of 38 recoveries in rooms of the stresses none is taken for
  // one.
  static constexpr double least_large = 0.05, least_huge_later = 0.25, least_far_later = 0.15;
  static constexpr double most_to_one_side = 0.7;

  bool most_fit() const { return judged_ >= fewest && !is_false_map() && large_ < most_large * judged_; }
  bool is_one_sided(int count) const {
    return count > most_to_one_side * large_ || large_ - count > most_to_one_side * large_;
  }

  int judged_ = 0, far_ = 0, large_ = 0, huge_ = 0;
  int large_and_far_ = 0, positive_ = 0, with_turn_ = 0;  // of the large ones
};

}  // namespace thermorig::odometer

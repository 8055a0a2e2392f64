// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "gyro_path.h"
#include "half_store.h"
#include "tracker.h"

namespace thermorig::odometer {

/// Holds the orders in which a camera may expose its rows against each other, on the halves of the start. A
/// tracker for each of the two that go row after row, beside that of the caller, which takes all rows at
/// once: with the right one, what a place showed at one speed is what it shows at another. Rivals may begin
/// with a wrong bias of the gyro, and be lost for that; once it is known they can be heard again.
class RowContest {
 public:
  /// `latency_measured`: the camera's times are those of its middle rows; else they may be those of the last.
  RowContest(const Priors& priors, const SharedLens& lens, bool latency_measured);

  /// Forgets all.
  void begin();
  /// Every order but the caller's begins anew, from what is known of the gyro by now. `is_scale_known`: one
  /// that is lost with it need not be heard again.
  void begin_again(RowOrder of_caller, const Priors& known, const HalfStore& store, bool is_scale_known);
  /// Since then each of them has gone through the store, or was lost on the way.
  bool are_heard(const HalfStore& store) const;
  /// With a gyro that is known another order than the caller's wins only if all were heard; where `must_hear`
  /// the caller's, too.
  bool may_end(const HalfStore& store, bool must_hear) const;

  /// The newest half of the store: a step for each rival, of about so much work. Returns the work of both.
  int add(const HalfStore& store, const GyroPath& path, int work_of_one);

  /// What the caller's tracker made of a half of the store.
  void note(RowOrder order, std::size_t place, const HalfResult& result);

  /// A margin of 0: nothing could be compared yet.
  FoundRows verdict() const;
  /// Another order than the caller's fits better, or with a gyro that is known still goes through the store.
  bool another_may_fit() const;

  /// Hands over the tracker of a rival that won, for the caller's. Returns how well its halves fit (NIS).
  double swap(RowOrder winner, Tracker& of_caller);

 private:
  struct Rival {
    explicit Rival(RowOrder its, const Priors& priors, const SharedLens& lens)
        : order(its), tracker(priors, lens) {}
    RowOrder order;
    Tracker tracker;
    Priors by_last_row, by_middle_row;
    bool has_begun = false;
    bool is_out = false;  // it was lost from what is known of the gyro
    int passes = 0;
    std::size_t gone_through = 0;  // halves of the store
    double nis = 1.0;
  };
  void begin(Rival& rival, const Priors& better, const HalfStore& store);
  void begin_pass(Rival& rival);
  int go_through(Rival& rival, const HalfStore& store, const GyroPath& path, int most);
  void give_up(Rival& rival);
  Rival& rival(RowOrder order) { return rivals_[0].order == order ? rivals_[0] : rivals_[1]; }
  const Rival& rival(RowOrder order) const { return rivals_[0].order == order ? rivals_[0] : rivals_[1]; }
  bool may_be_last_row(const Rival& rival) const {
    return !latency_measured_ && rival.order != RowOrder::at_once;
  }
  int passes_in_turn() const { return is_gyro_known_ ? 1 : 2; }  // with the times of the same row
  std::vector<float>& left_of(RowOrder order) { return left_k2_[static_cast<std::size_t>(order)]; }
  const std::vector<float>& left_of(RowOrder order) const {
    return left_k2_[static_cast<std::size_t>(order)];
  }
  bool is_out(RowOrder order) const { return order != of_caller_ && rival(order).is_out; }
  std::optional<double> lead(RowOrder order, RowOrder other) const;
  std::optional<double> margin_of(RowOrder order) const;

  Priors priors_;
  bool latency_measured_;
  bool is_gyro_known_ = false;  // and its scale
  RowOrder of_caller_ = RowOrder::at_once;
  std::array<Rival, 2> rivals_;
  std::array<std::vector<float>, 3> left_k2_;  // of each half, by order; NaN: not judged
};

}  // namespace thermorig::odometer

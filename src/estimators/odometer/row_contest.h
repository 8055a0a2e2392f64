// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "bias_search.h"
#include "gyro_path.h"
#include "half_store.h"
#include "tracker.h"

namespace thermorig::odometer {

/// Holds the orders in which a camera may expose its rows against each other, on the halves of the start. A
/// tracker for each of the two that go row after row, beside that of the caller, which takes all rows at
/// once: with the right one, what a place showed at one speed is what it shows at another.
class RowContest {
 public:
  /// `latency_measured`: the camera's times are those of its middle rows; else they may be those of the last.
  RowContest(const Priors& priors, const SharedLens& lens, bool latency_measured);

  /// Forgets all.
  void begin();

  /// The newest half of the store: a step for each rival, of bounded work. `is_busy`: the caller searches for
  /// the bias in the same step.
  void add(const HalfStore& store, const GyroPath& path, BiasSearch& search, bool is_busy);

  /// What the caller's tracker made of a half of the store.
  void note(std::size_t place, const HalfResult& result) { note(RowOrder::at_once, place, result); }

  /// A margin of 0: nothing could be compared yet.
  FoundRows verdict() const;

  /// The tracker of an order that won: the caller may take it, and begins the contest anew.
  Tracker& tracker(RowOrder order);
  double mean_nis(RowOrder order) const;

 private:
  struct Rival {
    explicit Rival(RowOrder its, const Priors& priors, const SharedLens& lens)
        : order(its), tracker(priors, lens) {}
    RowOrder order;
    Tracker tracker;
    Priors by_last_row, by_middle_row;
    bool has_begun = false;
    int passes = 0;
    std::size_t gone_through = 0;  // halves of the store
    double nis = 1.0;
  };
  void begin_pass(Rival& rival);
  void look_for_bias(Rival& rival, const HalfStore& store, const GyroPath& path, BiasSearch& search);
  int go_through(Rival& rival, const HalfStore& store, const GyroPath& path);  // returns looks at the map
  void note(RowOrder order, std::size_t place, const HalfResult& result);
  std::optional<double> lead(RowOrder order, RowOrder other) const;

  Priors priors_;
  bool latency_measured_;
  std::array<Rival, 2> rivals_;
  std::array<std::vector<float>, 3> left_k2_;  // of each half, by order; NaN: not judged
};

}  // namespace thermorig::odometer

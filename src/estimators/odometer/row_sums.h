// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "sweep_ends.h"
#include "thermorig/core/frame.h"

namespace thermorig::odometer {

/// Of each row of the map, what lies in all bins before: where pixels look apart, each of them looks at its
/// own ends of a sweep. All that is known of a bin lies side by side there.
class RowSums {
 public:
  /// Added up side by side, in one register.
  using Sum = float __attribute__((vector_size(4 * sizeof(float))));
  enum Part : std::size_t { temp_c, variance, seen };

  RowSums() : sums_(frame_rows * (Map::bins + 1)) {}

  /// Values bin after bin, of each all rows. None before `first` have changed since the last time.
  void add_up(const std::vector<float>& temps_c, const std::vector<float>& variances,
              const std::vector<float>& shares_seen, std::size_t first) {
    for (std::size_t bin = first; bin < Map::bins; ++bin)
      for (std::size_t row = 0; row < frame_rows; ++row) {
        const std::size_t from = bin * frame_rows + row;
        Sum* const before = &sums_[row * (Map::bins + 1) + bin];
        before[1] = before[0] + Sum{temps_c[from], variances[from], shares_seen[from]};
      }
  }

  Sum between(std::size_t row, const BinPosition& from, const BinPosition& to) const {
    const Sum* const of_row = &sums_[row * (Map::bins + 1)];
    return until(of_row, to) - until(of_row, from);
  }

 private:
  static Sum until(const Sum* of_row, const BinPosition& at) {
    const Sum &before = of_row[at.bin], &behind = of_row[at.bin + 1], &total = of_row[Map::bins];
    return before + (behind - before) * at.part + total * at.turns;
  }

  std::vector<Sum> sums_;
};

}  // namespace thermorig::odometer

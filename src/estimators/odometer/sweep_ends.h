// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// Between two bins of the map.
struct BinPosition {
  std::size_t bin = 0;              // before it
  float part = 0.0F, turns = 0.0F;  // of the way to the next one; whole turns beyond the map's ends
};

/// A bin beyond either end counts a whole turn; none is further away than one.
inline BinPosition bin_position(std::ptrdiff_t bin, float part) {
  constexpr auto all = static_cast<std::ptrdiff_t>(Map::bins);
  if (bin < 0) return {static_cast<std::size_t>(bin + all), part, -1.0F};
  if (bin >= all) return {static_cast<std::size_t>(bin - all), part, 1.0F};
  return {static_cast<std::size_t>(bin), part, 0.0F};
}

/// What a pixel sweeps ends there, and so much to either side of both.
struct SweepEnds {
  /// In bins, as `reach` is.
  SweepEnds(double low_at, double high_at, std::ptrdiff_t reach = 0) {
    put(low_at, reach, before_low, low, after_low);
    put(high_at, reach, before_high, high, after_high);
  }

  BinPosition before_low, low, after_low, before_high, high, after_high;

 private:
  static void put(double at, std::ptrdiff_t reach, BinPosition& before, BinPosition& here,
                  BinPosition& after) {
    const auto towards_0 = static_cast<std::ptrdiff_t>(at);
    const std::ptrdiff_t bin = static_cast<double>(towards_0) > at ? towards_0 - 1 : towards_0;
    const auto part = static_cast<float>(at - static_cast<double>(bin));
    before = bin_position(bin - reach, part);
    here = bin_position(bin, part);
    after = bin_position(bin + reach, part);
  }
};

}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "window_lines.h"

namespace thermorig::likelihood {

inline constexpr std::size_t least_halves = 2, most_halves = 4;
inline constexpr double largest_speed = 18.5;  // faster, a half shows little that the one before has shown
inline constexpr std::size_t patterns_a_group = 8;
inline constexpr std::size_t shared_waves = 5;  // the longest: both classes of rows see nearly the same

/// What a scene shows in the lines of a window at one speed, as patterns that come independently of each
/// other, the most common first: eigenvectors of their covariance.
struct SpeedPatterns {
  double speed = 0.0;
  std::size_t count = 0;        // of patterns; they stand in groups, the last one filled up with zeros
  std::vector<float> variance;  // of each pattern, for a scene of unit variance
  std::vector<float> pattern;   // (groups, lines, patterns_a_group)
  double trace = 0.0;           // of all variances, those of rare patterns that are left out too
};

/// The patterns of all speeds that are tried: ascending, symmetric about 0, closer where the camera is slow.
class SpeedTable {
 public:
  /// `halves`: least_halves to most_halves.
  explicit SpeedTable(std::size_t halves);

  /// How many speeds are tried, of however many halves. Takes no table.
  static std::size_t speeds();

  /// Made when it is first asked for, and kept: it depends on nothing else.
  static const SpeedTable& of(std::size_t halves);

  /// Of the lines of one class of rows: for waves of which each class sees its own.
  std::span<const SpeedPatterns> own() const { return own_; }
  /// Of the lines of both classes: for the shared waves but the longest. At the speeds from 0 on; at their
  /// opposites the classes change places.
  std::span<const SpeedPatterns> shared() const { return shared_; }
  /// The same for the longest wave, of lines less what those of each half have in common.
  std::span<const SpeedPatterns> longest() const { return longest_; }

 private:
  std::vector<SpeedPatterns> own_, shared_, longest_;
};

}  // namespace thermorig::likelihood

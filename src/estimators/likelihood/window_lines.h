// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "thermorig/core/frame.h"

namespace thermorig::likelihood {

// Lengths are in pitches of a pixel, speeds in pitches an exposure. A line is what one row of pixels shows in
// one half-frame: every second pixel of it.

inline constexpr std::size_t line_pixels = frame_columns / 2;
inline constexpr std::size_t half_rows = frame_rows / 2;

/// The pixels of one half-frame: (row, every second pixel of it).
using HalfLines = std::array<std::array<float, line_pixels>, frame_rows>;

/// A value for each wave up the columns: cosines over every second row, the longest first. They part what is
/// seen by its size, and only the first one sees what all pixels have in common.
using Waves = std::array<float, half_rows>;

/// of_rows[k][w]: wave w at the k-th of every second row; orthonormal.
const std::array<Waves, half_rows>& wave_table();

/// The halves of a window by waves, for two classes of rows: those whose line begins with column 0 in the
/// oldest half, and the others. The others are mirrored, so that theirs do too: a speed then counts with the
/// other sign.
class WindowLines {
 public:
  explicit WindowLines(std::size_t capacity);

  /// `parity`: of the oldest half. `halves`: from the oldest on, of alternating parity; at most `capacity`.
  void set(unsigned parity, std::span<const HalfLines* const> halves);

  std::size_t halves() const { return halves_; }
  std::size_t lines() const { return halves_ * line_pixels; }

  /// (lines, half_rows). Behind it a place more may be read than there are waves.
  const float* waves(std::size_t row_class) const { return waves_[row_class].data(); }
  /// Of the longest wave alone, less what each half has in common: (lines).
  const float* longest(std::size_t row_class) const { return longest_[row_class].data(); }
  /// Sum of the squares of a wave, of both classes; of the longest without what each half has in common.
  double energy(std::size_t wave) const { return energy_[wave]; }

 private:
  std::size_t halves_ = 0;
  std::array<std::vector<float>, 2> waves_, longest_;
  std::array<double, half_rows> energy_{};
};

}  // namespace thermorig::likelihood

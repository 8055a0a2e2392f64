// SPDX-License-Identifier: MIT
#include "thermorig/labels/freshness.h"

#include <array>

namespace thermorig::labels {

namespace {
constexpr std::uint16_t half_pixels = frame_pixels / 2;

/// Pixels of each column that differ, in rows of one parity. A loop that the compiler turns into vectors.
void count_row(const float* now, const float* before, std::array<std::uint32_t, frame_columns>& differ) {
  for (std::size_t column = 0; column < frame_columns; ++column)
    differ[column] += now[column] != before[column] ? 1U : 0U;
}
}  // namespace

Freshness FreshnessDetector::push(const ThermalFrame& frame) {
  Freshness fresh{.even = half_pixels, .odd = half_pixels};
  if (before_) {
    std::array<std::array<std::uint32_t, frame_columns>, 2> differ{};  // by row parity
    for (std::size_t row = 0; row < frame_rows; ++row)
      count_row(&frame.temp_c[row * frame_columns], &before_->temp_c[row * frame_columns], differ[row & 1U]);
    std::array<std::uint32_t, 2> half{};
    for (std::size_t row = 0; row < 2; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column)
        half[subpage_of(row, column)] += differ[row][column];
    fresh = {.even = static_cast<std::uint16_t>(half[0]), .odd = static_cast<std::uint16_t>(half[1])};
  }
  before_ = frame;
  return fresh;
}

void ModeVote::push(const Freshness& freshness) {
  if (freshness.both_fresh()) ++full_;
  if (freshness.one_fresh()) ++half_;
}

}  // namespace thermorig::labels

// SPDX-License-Identifier: MIT
#include "window_lines.h"

#include <cmath>
#include <numbers>

namespace thermorig::likelihood {

namespace {

std::array<Waves, half_rows> cosines() {
  std::array<Waves, half_rows> of_rows;
  constexpr double rows = half_rows;
  for (std::size_t row = 0; row < half_rows; ++row)
    for (std::size_t wave = 0; wave < half_rows; ++wave)
      of_rows[row][wave] = static_cast<float>(
          std::sqrt((wave == 0 ? 1.0 : 2.0) / rows) *
          std::cos(std::numbers::pi * static_cast<double>(wave) * (static_cast<double>(row) + 0.5) / rows));
  return of_rows;
}

}  // namespace

const std::array<Waves, half_rows>& wave_table() {
  static const std::array<Waves, half_rows> table = cosines();
  return table;
}

WindowLines::WindowLines(std::size_t capacity) {
  const std::size_t most_lines = capacity * line_pixels;
  for (auto& waves : waves_) waves.resize(most_lines * half_rows + 1);
  for (auto& longest : longest_) longest.resize(most_lines);
}

void WindowLines::set(unsigned parity, std::span<const HalfLines* const> halves) {
  const auto& of_rows = wave_table();
  halves_ = halves.size();
  energy_.fill(0.0);
  for (std::size_t row_class = 0; row_class < 2; ++row_class)
    for (std::size_t half = 0; half < halves_; ++half) {
      float* waves = &waves_[row_class][half * line_pixels * half_rows];
      float* longest = &longest_[row_class][half * line_pixels];
      float mean = 0.0F;
      for (std::size_t pixel = 0; pixel < line_pixels; ++pixel) {
        Waves sum{};
        for (std::size_t row = 0; row < half_rows; ++row) {
          const auto& line = (*halves[half])[2 * row + (row_class ^ parity)];
          const float temp_c = line[row_class == 0 ? pixel : line_pixels - 1 - pixel];
          for (std::size_t wave = 0; wave < half_rows; ++wave) sum[wave] += temp_c * of_rows[row][wave];
        }
        for (std::size_t wave = 0; wave < half_rows; ++wave) {
          waves[pixel * half_rows + wave] = sum[wave];
          if (wave > 0) energy_[wave] += double{sum[wave]} * double{sum[wave]};
        }
        longest[pixel] = sum[0];
        mean += sum[0] / static_cast<float>(line_pixels);
      }
      for (std::size_t pixel = 0; pixel < line_pixels; ++pixel) {
        longest[pixel] -= mean;
        energy_[0] += double{longest[pixel]} * double{longest[pixel]};
      }
    }
}

}  // namespace thermorig::likelihood

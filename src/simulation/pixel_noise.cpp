// SPDX-License-Identifier: MIT
#include "pixel_noise.h"

#include <algorithm>
#include <cmath>

namespace thermorig::simulation {
namespace {

constexpr double fixed_pattern_k = 0.15;  // standard deviation of a pixel's constant error
constexpr double column_pattern_k = 0.05;
constexpr double common_mode_k = 0.10;    // noise that a whole half shares
constexpr double warm_up_time_s = 120.0;  // time constant; the data sheet speaks of minutes
constexpr double glitches_per_half = 1e-4;

/// Distance from the middle of the image, 1 in the corners, squared.
double squared_radius(std::size_t row, std::size_t column) {
  const double y = (static_cast<double>(row) - 11.5) / 11.5;
  const double x = (static_cast<double>(column) - 15.5) / 15.5;
  return (x * x + y * y) / 2.0;
}

double median_squared_radius() {
  std::vector<double> radii;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column)
      radii.push_back(squared_radius(row, column));
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

}  // namespace

NoiseLevel NoiseLevel::of(double field_of_view_deg, double refresh_rate_hz) {
  const double scale = std::sqrt(refresh_rate_hz / 8.0);
  const bool wide = field_of_view_deg > 80.0;
  return wide ? NoiseLevel{0.37 * scale, 2.0} : NoiseLevel{0.66 * scale, 1.35};
}

PixelNoise::PixelNoise(const NoiseLevel& level, bool warm, std::uint64_t seed, const CameraWorld& world)
    : fixed_(seed, "camera fixed pattern"),
      random_(seed, "camera noise"),
      warm_(warm),
      warm_up_k_(fixed_.sign() * fixed_.uniform(0.5, 1.0)),
      world_warm_up_k_(world.warm_up_k),
      sensor_temp_c_(fixed_.uniform(28.0, 33.0)) {
  const double growth = level.corner_over_centre - 1.0;
  const double centre_k = level.median_k / (1.0 + growth * median_squared_radius());
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column)
      sigma_k_[column_index(row, column)] =
          static_cast<float>(centre_k * (1.0 + growth * squared_radius(row, column)));
  add_fixed_pattern();
  kill_pixels(fixed_.integer(0, 4), fixed_);  // the data sheet allows four
  Random more(seed, "camera dead pixels");
  kill_pixels(static_cast<int>(std::lround(world.dead_pixels)), more);
}

void PixelNoise::add_fixed_pattern() {
  const double chess_k = fixed_.sign() * fixed_.uniform(0.08, 0.16);  // even minus odd
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const double column_k = fixed_.normal(column_pattern_k);
    for (std::size_t row = 0; row < frame_rows; ++row) {
      const double half_k = subpage_of(row, column) == 0 ? 0.5 * chess_k : -0.5 * chess_k;
      offset_k_[column_index(row, column)] =
          static_cast<float>(half_k + column_k + fixed_.normal(fixed_pattern_k));
    }
  }
}

void PixelNoise::kill_pixels(int count, Random& random) {
  for (; count > 0; --count)
    dead_.push_back({static_cast<std::size_t>(random.integer(0, static_cast<int>(frame_pixels) - 1)),
                     static_cast<float>(random.uniform(-10.0, 60.0))});
}

void PixelNoise::grow(double factor) {
  for (float& sigma_k : sigma_k_) sigma_k *= static_cast<float>(factor);
}

void PixelNoise::read_half(const PixelColumns& seen_c, unsigned parity, double time_s, ThermalFrame& frame) {
  const double warming_k =
      (world_warm_up_k_ + (warm_ ? 0.0 : warm_up_k_)) * std::exp(-time_s / warm_up_time_s);
  const auto shared_k = static_cast<float>(random_.normal(common_mode_k) + warming_k);
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = (row ^ parity) & 1U; column < frame_columns; column += 2) {
      const std::size_t i = column_index(row, column);
      frame.temp_c[row * frame_columns + column] =
          seen_c[i] + offset_k_[i] + shared_k + sigma_k_[i] * static_cast<float>(random_.normal());
    }
  for (const DeadPixel& dead : dead_) frame.temp_c[dead.index] = dead.reading_c;
  if (!random_.chance(glitches_per_half)) return;
  const auto row = static_cast<std::size_t>(random_.integer(0, static_cast<int>(frame_rows) - 1));
  const auto pair = static_cast<std::size_t>(random_.integer(0, static_cast<int>(frame_columns) / 2 - 1));
  frame.temp_c[row * frame_columns + 2 * pair + ((row ^ parity) & 1U)] =
      static_cast<float>(random_.uniform(50.0, 700.0));
}

float PixelNoise::sensor_temp_c(double time_s) {
  sensor_wander_k_ = 0.999 * sensor_wander_k_ + random_.normal(0.005);
  const double cold_k = (5.0 * world_warm_up_k_ + (warm_ ? 0.0 : 5.0)) * std::exp(-time_s / warm_up_time_s);
  return static_cast<float>(sensor_temp_c_ - cold_k + sensor_wander_k_);
}

}  // namespace thermorig::simulation

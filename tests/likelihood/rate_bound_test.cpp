// SPDX-License-Identifier: MIT
#include "thermorig/estimators/likelihood/rate_bound.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "estimators/likelihood/speed_search.h"

namespace thermorig::likelihood {
namespace {

constexpr std::size_t columns = 420;
constexpr double pitch_deg = 55.0 / 32.0, exposure_s = 0.125;

/// Temperatures by row and azimuth.
using Scene = std::function<double(std::size_t row, double azimuth_deg)>;

std::vector<float> image_of(const Scene& scene) {
  std::vector<float> image_c;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      image_c.push_back(
          static_cast<float>(scene(row, (static_cast<double>(column) + 0.5) * 360.0 / columns)));
  return image_c;
}

/// Smooth random rows.
Scene random_scene(double contrast_k) {
  std::mt19937 random(3U);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  std::vector<double> phases;
  for (std::size_t i = 0; i < frame_rows * 40; ++i) phases.push_back(phase(random));
  return [=](std::size_t row, double azimuth_deg) {
    double sum = 0.0;
    for (std::size_t wave = 1; wave < 40; ++wave)
      sum += std::sin(static_cast<double>(wave) * azimuth_deg * std::numbers::pi / 180.0 +
                      phases[(row / 3) * 40 + wave]) /
             std::sqrt(static_cast<double>(wave));
    return 22.0 + contrast_k * sum;
  };
}

std::array<ExposedHalf, 4> four_halves() {
  std::array<ExposedHalf, 4> halves;
  for (unsigned i = 0; i < 4; ++i) halves[i] = {i & 1U, i * exposure_s, (i + 1) * exposure_s};
  return halves;
}

double bound_of(const std::vector<float>& image_c, double rate_dps, double noise_c,
                double heading_deg = 0.0) {
  const auto halves = four_halves();
  return rate_bound_dps(
      {.halves = halves, .heading_deg = heading_deg, .rate_dps = rate_dps, .noise_c = noise_c}, {image_c},
      {});
}

/// What a mirrored camera shows without noise.
HalfLines shown(const Scene& scene, const ExposedHalf& half, double heading_deg, double rate_dps) {
  constexpr int steps = 12;
  HalfLines lines{};
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t k = 0; k < line_pixels; ++k) {
      const auto column = static_cast<double>(2 * k + ((row ^ half.parity) & 1U));
      for (int i = 0; i < steps; ++i) {
        const double time_s = half.begin_s + exposure_s * (i + 0.5) / steps - 2.0 * exposure_s;
        lines[row][k] += static_cast<float>(
            scene(row, heading_deg + rate_dps * time_s - pitch_deg * (column - 15.5)) / steps);
      }
    }
  return lines;
}

TEST(TheBound, IsReachedWithinAFewTenthsAndNeverBeaten) {
  const Scene scene = random_scene(1.0);
  const std::vector<float> image_c = image_of(scene);
  const double noise_c = 0.5;
  const auto halves = four_halves();
  std::mt19937 random(9U);
  std::normal_distribution<double> normal(0.0, noise_c);
  SpeedSearch search;
  WindowLines window(4);
  for (const double rate_dps : {30.0, -120.0}) {
    double squares = 0.0, bound_squares = 0.0;
    constexpr int windows = 50;
    for (int n = 0; n < windows; ++n) {
      const double heading_deg = 7.2 * n;
      std::array<HalfLines, 4> seen;
      std::array<const HalfLines*, 4> pointers;
      for (std::size_t h = 0; h < 4; ++h) {
        seen[h] = shown(scene, halves[h], heading_deg, rate_dps);
        for (auto& line : seen[h])
          for (float& temp_c : line) temp_c += static_cast<float>(normal(random));
        pointers[h] = &seen[h];
      }
      window.set(0, pointers);
      const double speed_dps = -pitch_deg / exposure_s;
      const double found_dps = speed_dps * search.search(window, noise_c * noise_c, 18.0).speed;
      squares += (found_dps - rate_dps) * (found_dps - rate_dps);
      const double bound_dps = bound_of(image_c, rate_dps, noise_c, heading_deg);
      bound_squares += bound_dps * bound_dps;
    }
    const double multiple = std::sqrt(squares / bound_squares);
    EXPECT_GT(multiple, 0.8) << rate_dps;
    EXPECT_LT(multiple, 2.0) << rate_dps;
  }
}

TEST(TheBound, GrowsWithTheNoiseAndFallsWithTheContrast) {
  const std::vector<float> plain = image_of(random_scene(1.0)), strong = image_of(random_scene(3.0));
  const double bound_dps = bound_of(plain, 60.0, 0.5);
  EXPECT_GT(bound_of(plain, 60.0, 1.0), 1.5 * bound_dps);
  EXPECT_LT(bound_of(strong, 60.0, 0.5), bound_dps / 2.0);
  EXPECT_NEAR(bound_of(strong, 60.0, 1.5), bound_dps, 1e-3 * bound_dps);  // only their ratio counts
}

TEST(TheBound, GrowsWithTheSpeedThatBlurs) {
  const std::vector<float> image_c = image_of(random_scene(1.0));
  EXPECT_GT(bound_of(image_c, 150.0, 0.5), 2.0 * bound_of(image_c, 20.0, 0.5));
}

TEST(TheBound, OfMoreHalvesIsLower) {
  const std::vector<float> image_c = image_of(random_scene(1.0));
  const auto halves = four_halves();
  const BoundedWindow window{
      .halves = std::span(halves).first(2), .heading_deg = 0.0, .rate_dps = 60.0, .noise_c = 0.5};
  EXPECT_GT(rate_bound_dps(window, {image_c}, {}), 2.0 * bound_of(image_c, 60.0, 0.5));
}

TEST(TheBound, OfAWallIsInfinite) {
  const std::vector<float> image_c = image_of([](std::size_t, double) { return 22.0; });
  EXPECT_TRUE(std::isinf(bound_of(image_c, 60.0, 0.5)));
}

TEST(TheBound, OfWhatWasNeverSeenIsNotKnown) {
  std::vector<float> image_c = image_of(random_scene(1.0));
  for (std::size_t row = 0; row < frame_rows; ++row)
    image_c[row * columns + 10] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(bound_of(image_c, 60.0, 0.5)));
  EXPECT_TRUE(std::isfinite(bound_of(image_c, 60.0, 0.5, 180.0)));
}

}  // namespace
}  // namespace thermorig::likelihood

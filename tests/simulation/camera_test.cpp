// SPDX-License-Identifier: MIT
#include "simulation/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "frame_statistics.h"
#include "still_camera.h"

namespace thermorig::simulation {
namespace {

struct Changes {
  int even = 0;
  int odd = 0;
};

Changes changes(const ThermalFrame& before, const ThermalFrame& after) {
  Changes count;
  for (std::size_t i = 0; i < frame_pixels; ++i)
    if (before.temp_c[i] != after.temp_c[i])
      ++(subpage_of(i / frame_columns, i % frame_columns) == 0 ? count.even : count.odd);
  return count;
}

TEST(Camera, RefreshesOneChessHalfAFrameAndAlternates) {
  const auto frames = still_frames({.half_fresh = true}, make_panorama("dining", 1), 1, 0.0, 40);
  for (std::size_t i = 2; i < frames.size(); ++i) {
    const Changes now = changes(frames[i - 1].frame, frames[i].frame);
    const Changes before = changes(frames[i - 2].frame, frames[i - 1].frame);
    EXPECT_GE(std::max(now.even, now.odd), 380);  // all but dead pixels
    EXPECT_EQ(std::min(now.even, now.odd), 0);
    EXPECT_EQ(now.even > 0, before.odd > 0);
  }
}

TEST(Camera, RefreshesBothHalvesInFullFreshMode) {
  const auto frames = still_frames({.half_fresh = false}, make_panorama("dining", 1), 1, 0.0, 10);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Changes now = changes(frames[i - 1].frame, frames[i].frame);
    EXPECT_GE(std::min(now.even, now.odd), 380);
  }
}

TEST(Camera, StartsWithEitherHalfDependingOnThePowerUp) {
  std::set<bool> even_first;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto frames = still_frames({}, make_panorama("dining", 1), seed, 0.0, 2);
    even_first.insert(changes(frames[0].frame, frames[1].frame).even > 0);
  }
  EXPECT_EQ(even_first.size(), 2U);
}

TEST(Camera, ExposesAFrameOverTwoRefreshPeriodsOfItsSlowClock) {
  for (const bool half_fresh : {true, false}) {
    const auto frames = still_frames({.half_fresh = half_fresh}, make_panorama("laboratory", 1), 3, 0.0, 80);
    const double refresh_s = (half_fresh ? 0.125 : 0.0625) / 0.98;
    const double frame_s =
        1e-9 * static_cast<double>(frames.back().exposure_end.time_ns - frames.front().exposure_end.time_ns) /
        79.0;
    EXPECT_NEAR(frame_s, 0.125 / 0.98, 0.001 * 0.125);
    for (const auto& frame : frames) {
      const auto exposure_ns = frame.exposure_end.time_ns - frame.exposure_begin.time_ns;
      EXPECT_NEAR(1e-9 * static_cast<double>(exposure_ns), 2.0 * refresh_s, 0.002 * refresh_s);
      EXPECT_GT(frame.ready_ns, frame.exposure_end.time_ns);
    }
  }
}

/// Mean squared difference of the fresh half of two frames when the later one is moved back by `shift`
/// columns.
double mismatch(const ThermalFrame& before, const ThermalFrame& after, unsigned parity, int shift) {
  double squares = 0.0;
  int count = 0;
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 32; ++column) {
      const int moved = column + shift;
      if (moved < 0 || moved >= 32 || subpage_of(std::size_t(row), std::size_t(column)) != parity) continue;
      const double difference = static_cast<double>(before.temp_c[std::size_t(row * 32 + column)]) -
                                static_cast<double>(after.temp_c[std::size_t(row * 32 + moved)]);
      squares += difference * difference;
      ++count;
    }
  return squares / count;
}

/// Rate at which the scene moves `columns` columns while one half is refreshed once.
double rate_for(int columns, double field_of_view_deg) {
  return columns * field_of_view_deg / 32.0 / (2.0 * 0.125 / 0.98);
}

/// The even shift by which the image moved between frames two apart.
int measured_shift(const CameraConfig& config, double rate_dps) {
  const auto frames = turning_frames(config, make_panorama("garden", 4), 4, rate_dps, 12);
  const auto& before = frames[9].frame;
  const auto& after = frames[11].frame;
  const unsigned fresh = changes(frames[10].frame, after).even > 0 ? 0U : 1U;
  int best = -100;
  double least = 1e9;
  for (int shift = -10; shift <= 10; shift += 2) {
    const double error = mismatch(before, after, fresh, shift);
    if (error < least) {
      least = error;
      best = shift;
    }
  }
  return best;
}

TEST(Camera, MovesTheMirroredSceneTowardLargerColumnsWhenItTurnsRight) {
  EXPECT_EQ(measured_shift({}, rate_for(6, 55.0)), 6);
  EXPECT_EQ(measured_shift({}, -rate_for(6, 55.0)), -6);
}

TEST(Camera, MovesTheNaturalSceneTowardSmallerColumnsWhenItTurnsRight) {
  EXPECT_EQ(measured_shift({.mirrored = false}, rate_for(4, 55.0)), -4);
}

TEST(Camera, MovesTheSceneByHalfAsManyColumnsBehindTheWideLens) {
  EXPECT_EQ(measured_shift({.field_of_view_deg = 110.0}, rate_for(8, 55.0)), 4);
}

TEST(Camera, BlursWhatMovesDuringTheExposure) {
  const auto contrast = [](double rate_dps) {
    const auto frames = turning_frames({}, make_panorama("laboratory", 8), 8, rate_dps, 60);
    double sum = 0.0;  // of differences between pixels of one half, next but one in a row
    for (const auto& frame : frames)
      for (std::size_t i = 2; i < frame_columns; ++i)
        sum += std::abs(frame.frame.temp_c[12 * frame_columns + i] -
                        frame.frame.temp_c[12 * frame_columns + i - 2]);
    return sum;
  };
  EXPECT_LT(contrast(150.0), contrast(2.0));
}

TEST(Camera, DriftsWhileItWarmsUpAndNotWhenItIsWarm) {
  const auto sensor_rise_k = [](bool warm) {
    const auto frames = still_frames({.warm = warm}, make_panorama("laboratory", 1), 5, 0.0, 1600);
    return frames.back().frame.sensor_temp_c - frames.front().frame.sensor_temp_c;
  };
  EXPECT_GT(sensor_rise_k(false), 2.0F);
  EXPECT_LT(std::abs(sensor_rise_k(true)), 0.8F);
}

TEST(Camera, HasAtMostFourDeadPixels) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto frames = still_frames({}, make_panorama("laboratory", 1), seed, 0.0, 4);
    int dead = 0;
    for (std::size_t i = 0; i < frame_pixels; ++i)
      dead += frames[0].frame.temp_c[i] == frames[3].frame.temp_c[i] ? 1 : 0;
    EXPECT_LE(dead, 4);
  }
}

TEST(PixelNoise, GlitchesRarely) {
  PixelNoise noise(NoiseLevel::of(55.0, 8.0), true, 6);
  PixelColumns seen;
  seen.fill(22.0F);
  ThermalFrame frame;
  noise.read_half(seen, 0, 0.0, frame);
  noise.read_half(seen, 1, 0.0, frame);
  int glitches = 0;
  for (unsigned half = 0; half < 40000; ++half) {
    const ThermalFrame before = frame;
    noise.read_half(seen, half % 2, 0.0, frame);
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      glitches += frame.temp_c[pixel] > before.temp_c[pixel] + 25.0F ? 1 : 0;
  }
  EXPECT_GE(glitches, 1);  // 4 are expected
  EXPECT_LE(glitches, 12);
}

}  // namespace
}  // namespace thermorig::simulation

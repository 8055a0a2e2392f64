// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "frame_statistics.h"
#include "still_camera.h"

// The simulated camera at rest beside what real MLX90640 recordings and the data sheet (rev 11) say.
// room     a room seen by a 55 degree module: yxiao1996/ThermalFallDetection, 26 recordings of 189 frames
// streamer rtubio/mlx90640-streamer, 10 recordings, 7,032 frames
// moving   655 frames of a GY-MCU90640 in the hand, 110 degree lens
// sheet    Melexis data sheet rev 11, figures 19 to 23

namespace thermorig::simulation {
namespace {

struct Range {
  double low, high;
  const char* source;
};

void expect_within(double value, const Range& range, const std::string& what) {
  EXPECT_GE(value, range.low) << what << ", measured: " << range.source;
  EXPECT_LE(value, range.high) << what << ", measured: " << range.source;
}

/// Figures of several motionless recordings, each toward another side of another room.
struct Recordings {
  std::map<std::string, std::vector<double>> figures;

  Recordings(const CameraConfig& config, const std::string& environment, std::size_t frames) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Panorama panorama = make_panorama(environment, seed);
      for (int side = 0; side < 2; ++side) {
        const double yaw_deg = 180.0 * side + 37.0 * static_cast<double>(seed);
        add(still_statistics(still_frames(config, panorama, seed, yaw_deg, frames)));
      }
    }
  }

  void add(const StillStatistics& still) {
    figures["noise"].push_back(still.noise_median_k);
    figures["centre"].push_back(still.noise_centre_k);
    figures["corner"].push_back(still.noise_corner_k);
    figures["corner over centre"].push_back(still.noise_corner_k / still.noise_centre_k);
    figures["lag one"].push_back(still.lag_one);
    figures["common mode"].push_back(still.common_mode_k);
    figures["pattern"].push_back(still.pattern_k);
    figures["chess offset"].push_back(std::abs(still.chess_offset_k));
    figures["spatial"].push_back(still.spatial_k);
    figures["low"].push_back(still.low_c);
    figures["high"].push_back(still.high_c);
    figures["repeat"].push_back(still.repeat_correlation);
  }

  double median(const std::string& name) const { return median_of(figures.at(name)); }
};

TEST(Realism, NoiseOfTheNarrowLensAtEightHertzIsThatOfRealRecordings) {
  const Recordings room({}, "dining", 120);
  expect_within(room.median("noise"), {0.59, 0.72, "room 0.59-0.72 K, sheet 0.66 K"}, "temporal noise");
  expect_within(room.median("centre"), {0.50, 0.75, "sheet, fig 20-23"}, "noise in the centre");
  expect_within(room.median("corner"), {0.65, 1.30, "sheet, fig 20-23"}, "noise in the corners");
  expect_within(room.median("corner over centre"), {1.18, 2.2, "room 1.18, streamer 1.9-2.2"}, "corners");
  expect_within(room.median("lag one"), {-0.56, -0.39, "streamer -0.39 to -0.56; white: -0.5"}, "lag one");
  expect_within(room.median("common mode"),
                {0.10, 0.58, "streamer 0.12-0.58 K; the honest camera is a little quieter than any of them"},
                "common mode");
}

TEST(Realism, FixedPatternAndChessOffsetAreThoseOfRealRecordings) {
  const Recordings room({}, "dining", 120);
  expect_within(room.median("pattern"), {0.12, 0.39, "room 0.19-0.27 K, streamer 0.12-0.39 K"}, "pattern");
  expect_within(room.median("chess offset"), {0.06, 0.44, "room below 0.17 K, streamer 0.06-0.44 K"},
                "chess");
}

TEST(Realism, NoiseOfTheWideLensIsThatOfTheDataSheetAndOfARealBoard) {
  // A GY-MCU90640 that sends 4 whole frames a second refreshes 8 halves a second.
  const Recordings board({.field_of_view_deg = 110.0, .output_rate_hz = 4.0, .half_fresh = false},
                         "laboratory", 80);
  expect_within(board.median("noise"), {0.27, 0.38, "moving 0.27-0.30 K, sheet 0.37-0.38 K"},
                "temporal noise");
  expect_within(board.median("corner over centre"), {1.5, 2.5, "moving 2"}, "corners");
}

TEST(Realism, NoiseGrowsWithTheRootOfTheRefreshRate) {
  const Recordings fast({.half_fresh = false}, "laboratory", 80);  // 16 halves a second
  expect_within(fast.median("noise"), {0.92, 1.0, "sheet 0.98 K at 16 Hz; 8 Hz times the root of 2: 0.93"},
                "temporal noise");
}

TEST(Realism, RoomsAndGardensHaveTheContrastOfRealViews) {
  const std::map<std::string, Range> spatial{
      {"laboratory", {0.57, 1.06, "room 0.57-1.06 K"}},
      {"dining", {0.57, 2.1, "room 0.57-1.06 K, somebody near 1.6-2.1 K"}},
      {"kitchen", {0.57, 1.06, "room 0.57-1.06 K"}},
      {"garden", {2.7, 19.0, "moving, 2.7-19 K"}}};
  for (const auto& [environment, range] : spatial)
    expect_within(Recordings({}, environment, 12).median("spatial"), range, "contrast of " + environment);
}

TEST(Realism, RoomsHaveTheTemperaturesAndTheRepeatabilityOfRealViews) {
  for (const std::string environment : {"laboratory", "dining", "kitchen"}) {
    const Recordings room({}, environment, 12);
    expect_within(room.median("low"), {19.5, 22.0, "room from 20 degC on"},
                  "1st percentile of " + environment);
    expect_within(room.median("high"), {24.0, 29.0, "room up to 29 degC"},
                  "99th percentile of " + environment);
    expect_within(room.median("repeat"), {0.60, 0.91, "room 0.60-0.91"}, "two frames of " + environment);
  }
}

}  // namespace
}  // namespace thermorig::simulation

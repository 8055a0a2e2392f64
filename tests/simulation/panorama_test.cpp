// SPDX-License-Identifier: MIT
#include "thermorig/simulation/panorama.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/optics.h"
#include "thermorig/core/error.h"

namespace thermorig::simulation {
namespace {

TEST(Panorama, IsTheSameForTheSameEnvironmentAndSeed) {
  EXPECT_EQ(make_panorama("kitchen", 5).temp_c, make_panorama("kitchen", 5).temp_c);
}

TEST(Panorama, ChangesWithTheSeedAndWithTheEnvironment) {
  const auto kitchen = make_panorama("kitchen", 5).temp_c;
  EXPECT_NE(kitchen, make_panorama("kitchen", 6).temp_c);
  EXPECT_NE(kitchen, make_panorama("dining", 5).temp_c);
}

TEST(Panorama, IsTheSameWhateverCompilesIt) {
  const auto expect_seen = [](const char* environment, double ahead_c, double elsewhere_c) {
    const Panorama panorama = make_panorama(environment, 5);
    EXPECT_NEAR(panorama.at(90, 100), ahead_c, 1e-3) << environment;
    EXPECT_NEAR(panorama.at(60, 1000), elsewhere_c, 1e-3) << environment;
  };
  expect_seen("laboratory", 22.2097, 21.0024);
  expect_seen("dining", 24.7338, 28.0006);
  expect_seen("kitchen", 22.9960, 22.0429);
  expect_seen("garden", 30.9179, 39.0481);
}

TEST(Panorama, OfANameWithoutASceneIsALaboratory) {
  EXPECT_EQ(scene_of("attic"), "laboratory");
  EXPECT_EQ(scene_of("garden"), "garden");
  EXPECT_EQ(make_panorama("attic", 5).temp_c, make_panorama("attic", 5, "laboratory").temp_c);
  EXPECT_NE(make_panorama("attic", 5).temp_c, make_panorama("attic", 5, "garden").temp_c);
}

TEST(Panorama, OfASceneThatThereIsNotIsRefused) {
  try {
    make_panorama("attic", 5, "kitchn");
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_EQ(error.advice(), "did you mean \"kitchen\"? one of: kitchen, dining, garden, laboratory");
  }
}

TEST(Panorama, KeepsToTemperaturesThatTheSensorCanShow) {
  for (const char* environment : {"laboratory", "dining", "kitchen", "garden", "attic"})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto panorama = make_panorama(environment, seed);
      const auto [low, high] = std::minmax_element(panorama.temp_c.begin(), panorama.temp_c.end());
      EXPECT_GT(*low, -20.0F) << environment << seed;
      EXPECT_LT(*high, 130.0F) << environment << seed;
    }
}

TEST(Panorama, OfAGardenHasACoolSkyOverWarmGround) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto garden = make_panorama("garden", seed);
    EXPECT_GT(garden.at(20, 0), garden.at(Panorama::elevations - 1, 0) + 10.0F) << seed;
  }
}

TEST(Optics, ShowsTheSameViewAfterAWholeTurnAndNoSeam) {
  const auto panorama = make_panorama("laboratory", 2);
  const Optics optics(panorama, FieldOfView::of_width(55.0), true);
  PixelColumns once, again, beside;
  optics.view(-3.3, once);
  optics.view(720.0 - 3.3, again);
  optics.view(-3.3001, beside);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    EXPECT_NEAR(once[i], again[i], 1e-3);
    EXPECT_NEAR(once[i], beside[i], 1e-2);
  }
}

TEST(Optics, PutsAHotSpotWhereTheMirroredAndTheNaturalOrderHaveIt) {
  Panorama panorama;
  const int azimuth = 40;  // 10 degrees to the right
  for (int row = 85; row < 96; ++row)
    for (int i = -3; i <= 3; ++i) panorama.at(row, azimuth + i) = 100.0F;
  const auto hottest_column = [&](bool mirrored) {
    PixelColumns view;
    Optics(panorama, FieldOfView::of_width(55.0), mirrored).view(0.0, view);
    const auto hottest = std::max_element(view.begin(), view.end()) - view.begin();
    return static_cast<std::size_t>(hottest) / frame_rows;
  };
  EXPECT_EQ(hottest_column(false), 21U);  // 15.5 + 10 / 1.72
  EXPECT_EQ(hottest_column(true), 10U);
}

TEST(Optics, PutsTheSkyIntoTheUpperRows) {
  const auto panorama = make_panorama("garden", 1);
  PixelColumns view;
  Optics(panorama, FieldOfView::of_width(110.0), true).view(0.0, view);
  EXPECT_LT(view[column_index(0, 16)], view[column_index(frame_rows - 1, 16)] - 5.0F);
}

TEST(FieldOfView, IsThatOfTheTwoLensesOfTheDataSheet) {
  EXPECT_DOUBLE_EQ(FieldOfView::of_width(55.0).height_deg, 35.0);
  EXPECT_DOUBLE_EQ(FieldOfView::of_width(110.0).height_deg, 75.0);
}

}  // namespace
}  // namespace thermorig::simulation

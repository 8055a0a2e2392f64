// SPDX-License-Identifier: MIT
#include "estimators/odometer/innovations.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

/// As far off as was expected of one standard deviation, to that side.
HalfResult off_by(double innovation_deg, double rate_dps) {
  return {.squared = 1.0, .innovation_deg = innovation_deg, .rate_dps = rate_dps};
}

TEST(MeanInnovation, IsMuchOnceTwentyHalvesLieOneSigmaToOneSide) {
  MeanInnovation lean;
  lean.begin(50.0);
  for (int i = 0; i < 15; ++i) lean.add(off_by(-0.2, 50.0));
  EXPECT_FALSE(lean.is_one_sided(false));
  for (int i = 0; i < 5; ++i) lean.add(off_by(-0.2, 50.0));
  EXPECT_TRUE(lean.is_one_sided(false));
  EXPECT_FALSE(lean.is_one_sided(true));
}

TEST(MeanInnovation, IsNoneOfInnovationsToEitherSide) {
  MeanInnovation lean;
  lean.begin(50.0);
  for (int i = 0; i < 200; ++i) lean.add(off_by(i % 2 == 0 ? 0.2 : -0.2, 50.0));
  EXPECT_FALSE(lean.is_one_sided(false));
}

TEST(MeanInnovation, CameWithAnotherSpeedForSomeSecondsAfterItChanged) {
  MeanInnovation lean;
  lean.begin(50.0);
  for (int i = 0; i < 20; ++i) lean.add(off_by(0.2, 50.0));
  EXPECT_FALSE(lean.came_with_other_speed(50.0));
  for (int i = 0; i < 20; ++i) lean.add(off_by(0.2, -50.0));
  EXPECT_TRUE(lean.came_with_other_speed(-50.0));
  for (int i = 0; i < 40; ++i) lean.add(off_by(0.2, -50.0));
  EXPECT_FALSE(lean.came_with_other_speed(-50.0));
}

TEST(MeanInnovation, BeginsAtTheSpeedThatTheRigHas) {
  MeanInnovation lean;
  lean.begin(170.0);
  lean.add(off_by(0.2, 170.0));
  EXPECT_FALSE(lean.came_with_other_speed(170.0));
}

}  // namespace
}  // namespace thermorig::odometer

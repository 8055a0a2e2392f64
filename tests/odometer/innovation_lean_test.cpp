// SPDX-License-Identifier: MIT
#include "estimators/odometer/innovation_lean.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

/// As far off as was expected of one standard deviation, to that side.
HalfResult off_by(double innovation_deg, double rate_dps) {
  return {.squared = 1.0, .innovation_deg = innovation_deg, .rate_dps = rate_dps};
}

TEST(InnovationLean, IsMuchOnceTwentyHalvesLieOneSigmaToOneSide) {
  InnovationLean lean;
  lean.begin(50.0);
  for (int i = 0; i < 15; ++i) lean.add(off_by(-0.2, 50.0));
  EXPECT_FALSE(lean.is_much(false));
  for (int i = 0; i < 5; ++i) lean.add(off_by(-0.2, 50.0));
  EXPECT_TRUE(lean.is_much(false));
  EXPECT_FALSE(lean.is_much(true));
}

TEST(InnovationLean, IsNoneOfInnovationsToEitherSide) {
  InnovationLean lean;
  lean.begin(50.0);
  for (int i = 0; i < 200; ++i) lean.add(off_by(i % 2 == 0 ? 0.2 : -0.2, 50.0));
  EXPECT_FALSE(lean.is_much(false));
}

TEST(InnovationLean, CameWithAnotherSpeedForSomeSecondsAfterItChanged) {
  InnovationLean lean;
  lean.begin(50.0);
  for (int i = 0; i < 20; ++i) lean.add(off_by(0.2, 50.0));
  EXPECT_FALSE(lean.came_with_other_speed(50.0));
  for (int i = 0; i < 20; ++i) lean.add(off_by(0.2, -50.0));
  EXPECT_TRUE(lean.came_with_other_speed(-50.0));
  for (int i = 0; i < 40; ++i) lean.add(off_by(0.2, -50.0));
  EXPECT_FALSE(lean.came_with_other_speed(-50.0));
}

TEST(InnovationLean, BeginsAtTheSpeedThatTheRigHas) {
  InnovationLean lean;
  lean.begin(170.0);
  lean.add(off_by(0.2, 170.0));
  EXPECT_FALSE(lean.came_with_other_speed(170.0));
}

}  // namespace
}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
#include "estimators/odometer/innovations.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

/// As far off as was expected of one standard deviation, to that side.
HalfResult off_by(double innovation_deg, double rate_dps) {
  return {.nis = 1.0, .innovation_deg = innovation_deg, .rate_dps = rate_dps};
}

TEST(MeanInnovation, IsMuchOnceTwentyHalvesLieOneSigmaToOneSide) {
  MeanInnovation innovation;
  innovation.begin(50.0);
  for (int i = 0; i < 15; ++i) innovation.add(off_by(-0.2, 50.0));
  EXPECT_FALSE(innovation.is_one_sided(false));
  for (int i = 0; i < 5; ++i) innovation.add(off_by(-0.2, 50.0));
  EXPECT_TRUE(innovation.is_one_sided(false));
  EXPECT_FALSE(innovation.is_one_sided(true));
}

TEST(MeanInnovation, IsNoneOfInnovationsToEitherSide) {
  MeanInnovation innovation;
  innovation.begin(50.0);
  for (int i = 0; i < 200; ++i) innovation.add(off_by(i % 2 == 0 ? 0.2 : -0.2, 50.0));
  EXPECT_FALSE(innovation.is_one_sided(false));
}

TEST(MeanInnovation, CameWithAnotherSpeedForSomeSecondsAfterItChanged) {
  MeanInnovation innovation;
  innovation.begin(50.0);
  for (int i = 0; i < 20; ++i) innovation.add(off_by(0.2, 50.0));
  EXPECT_FALSE(innovation.came_with_other_speed(50.0));
  for (int i = 0; i < 20; ++i) innovation.add(off_by(0.2, -50.0));
  EXPECT_TRUE(innovation.came_with_other_speed(-50.0));
  for (int i = 0; i < 40; ++i) innovation.add(off_by(0.2, -50.0));
  EXPECT_FALSE(innovation.came_with_other_speed(-50.0));
}

TEST(MeanInnovation, BeginsAtTheSpeedThatTheRigHas) {
  MeanInnovation innovation;
  innovation.begin(170.0);
  innovation.add(off_by(0.2, 170.0));
  EXPECT_FALSE(innovation.came_with_other_speed(170.0));
}

}  // namespace
}  // namespace thermorig::odometer

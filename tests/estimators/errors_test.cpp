// SPDX-License-Identifier: MIT
#include "thermorig/estimators/errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::estimators {
namespace {

TEST(RateErrors, AreAMeanAndAMeanSquare) {
  RateErrors errors;
  for (const double error_dps : {30.0, -10.0}) errors.add(error_dps);
  EXPECT_EQ(errors.count(), 2U);
  EXPECT_DOUBLE_EQ(errors.mean_dps(), 10.0);
  EXPECT_DOUBLE_EQ(errors.rmse_dps(), std::sqrt(500.0));
  EXPECT_DOUBLE_EQ(errors.mse(200.0), 0.0125);
}

TEST(RateErrors, OfNothingAreUnknown) {
  EXPECT_TRUE(std::isnan(RateErrors().mean_dps()));
  EXPECT_TRUE(std::isnan(RateErrors().rmse_dps()));
  EXPECT_TRUE(std::isnan(RateErrors().mse(200.0)));
}

TEST(AngleError, OfASteadyErrorIsItsTimeAndItsSlopeIsIt) {
  AngleError error;
  for (int i = 0; i < 10; ++i) error.add(-3.0, 0.5);
  EXPECT_DOUBLE_EQ(error.angle_deg(), -15.0);
  EXPECT_DOUBLE_EQ(error.integrated_s(), 5.0);
  EXPECT_DOUBLE_EQ(error.worst_deg(), 15.0);
  EXPECT_DOUBLE_EQ(error.drift_deg_per_min(), -180.0);
  EXPECT_DOUBLE_EQ(error.slope_deg_per_min(), -180.0);
}

TEST(AngleError, ThatTurnsBackHasASlopeThoughItEndsAtNothing) {
  AngleError error;
  error.add(4.0, 1.0);
  error.add(-4.0, 1.0);
  EXPECT_DOUBLE_EQ(error.angle_deg(), 0.0);
  EXPECT_DOUBLE_EQ(error.worst_deg(), 4.0);
  EXPECT_DOUBLE_EQ(error.drift_deg_per_min(), 0.0);
  EXPECT_DOUBLE_EQ(error.slope_deg_per_min(), 60.0 * 4.0 / 5.0);  // through (1 s, 4 deg) and (2 s, 0 deg)
}

TEST(AngleError, OfNoTimeHasNoDrift) {
  AngleError error;
  EXPECT_FALSE(error.has_begun());
  EXPECT_TRUE(std::isnan(error.worst_deg()));
  error.add(5.0, 0.0);
  EXPECT_TRUE(std::isnan(error.drift_deg_per_min()) && std::isnan(error.slope_deg_per_min()));
  EXPECT_DOUBLE_EQ(error.worst_deg(), 0.0);
}

}  // namespace
}  // namespace thermorig::estimators

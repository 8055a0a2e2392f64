// SPDX-License-Identifier: MIT
#include "simulation/random.h"

#include <gtest/gtest.h>

#include <vector>

#include "frame_statistics.h"

namespace thermorig::simulation {
namespace {

std::vector<double> draws(Random random, double (*draw)(Random&)) {
  std::vector<double> values(20000);
  for (double& value : values) value = draw(random);
  return values;
}

TEST(Random, RepeatsWithItsSeedAndStreamAndOnlyThen) {
  const auto first = Random(7, "camera").bits();
  EXPECT_EQ(first, Random(7, "camera").bits());
  EXPECT_NE(first, Random(8, "camera").bits());
  EXPECT_NE(first, Random(7, "gyro").bits());
}

TEST(Random, NormalNumbersHaveMeanZeroAndDeviationOne) {
  const auto values = draws(Random(1, "test"), [](Random& random) { return random.normal(); });
  EXPECT_NEAR(median_of(values), 0.0, 0.03);
  EXPECT_NEAR(deviation_of(values), 1.0, 0.02);
  EXPECT_NEAR(quantile_of(values, 0.975), 1.96, 0.06);
}

TEST(Random, ExponentialNumbersHaveTheirMeanAndNoneIsNegative) {
  const auto values = draws(Random(1, "test"), [](Random& random) { return random.exponential(2.0); });
  EXPECT_NEAR(median_of(values), 2.0 * 0.6931, 0.06);
  EXPECT_GE(quantile_of(values, 0.0), 0.0);
}

TEST(Random, IntegersReachBothEndsAndNoFurther) {
  const auto values =
      draws(Random(1, "test"), [](Random& random) { return static_cast<double>(random.integer(-1, 2)); });
  EXPECT_EQ(quantile_of(values, 0.0), -1.0);
  EXPECT_EQ(quantile_of(values, 1.0), 2.0);
}

}  // namespace
}  // namespace thermorig::simulation

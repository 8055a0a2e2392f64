// SPDX-License-Identifier: MIT
#include "thermorig/core/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace thermorig {
namespace {

TEST(Median, IsTheMiddleOrTheUpperOfTheTwoInTheMiddle) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median({}), 0.0);
  std::array values{9.0F, 7.0F, 8.0F, 1.0F};
  EXPECT_EQ(reordering_median(std::span(values).first(3)), 8.0F);
  EXPECT_EQ(values[3], 1.0F);  // not one of them
}

TEST(RobustDeviation, IsThatOfANormalDistributionWhateverAFewOutliersAre) {
  EXPECT_DOUBLE_EQ(robust_deviation({9.0, 10.0, 11.0, 10.0, 1e9}, 10.0), 1.4826);
  EXPECT_EQ(robust_deviation({}, 0.0), 0.0);
}

TEST(Quantiles, AreOneOfTheValuesRoundedDownOrUp) {
  std::vector<double> values{50.0, 10.0, 40.0, 20.0, 30.0};
  EXPECT_EQ(lower_quantile(values, 0.0), 10.0);
  EXPECT_EQ(lower_quantile(values, 0.6), 30.0);
  EXPECT_EQ(upper_quantile(values, 0.6), 40.0);
  EXPECT_EQ(lower_quantile(values, 1.0), 50.0);
  EXPECT_EQ(upper_quantile(values, 0.5), 30.0);
  EXPECT_EQ(lower_quantile(std::vector<double>{}, 0.5), 0.0);
  EXPECT_EQ(upper_quantile(std::vector<double>{}, 0.5), 0.0);
}

TEST(Quantile, OfSortedValuesLiesBetweenThem) {
  const std::vector<double> sorted{10.0, 20.0, 40.0};
  EXPECT_DOUBLE_EQ(quantile(sorted, 0.25), 15.0);
  EXPECT_DOUBLE_EQ(quantile(sorted, 0.75), 30.0);
  EXPECT_EQ(quantile(sorted, 1.0), 40.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(RunningStatistics, AreThoseOfAllNumbersThatCame) {
  RunningStatistics statistics;
  EXPECT_EQ(statistics.variance(), 0.0);
  for (const double value : {1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0, 1e9 + 6.0}) {
    statistics.add(value);
    if (statistics.count() == 1) {
      EXPECT_EQ(statistics.sample_variance(), 0.0);
    }
  }
  EXPECT_EQ(statistics.count(), 4U);
  EXPECT_DOUBLE_EQ(statistics.mean(), 1e9 + 3.0);
  EXPECT_DOUBLE_EQ(statistics.variance(), 3.5);  // not lost beside the mean's square
  EXPECT_DOUBLE_EQ(statistics.sample_variance(), 14.0 / 3.0);
}

TEST(RecentCount, TellsWhatHappensOftenFromWhatHappensNowAndThen) {
  RecentCount rare, frequent;
  for (int i = 0; i < 1000; ++i) {
    rare.add(i % 100 == 0);
    frequent.add(i % 20 == 0);
  }
  EXPECT_FALSE(rare.is_frequent());
  EXPECT_TRUE(frequent.is_frequent());
  for (int i = 0; i < 200; ++i) frequent.add(false);
  EXPECT_FALSE(frequent.is_frequent());
}

}  // namespace
}  // namespace thermorig

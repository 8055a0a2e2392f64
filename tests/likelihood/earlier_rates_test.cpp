// SPDX-License-Identifier: MIT
#include "estimators/likelihood/speed_search.h"

#include <gtest/gtest.h>

namespace thermorig::likelihood {
namespace {

HostTime at(double time_s) {
  return HostTime(from_s(time_s));
}

TEST(EarlierRates, AreOfTheNewestWindowThatEndedBefore) {
  EarlierRates rates;
  EXPECT_FALSE(rates.expected(at(1.0), at(1.5)));
  for (int i = 0; i < 20; ++i) rates.add({at(1.0 + 0.125 * i), 10.0 * i, 2.0});
  const auto expected = rates.expected(at(1.0 + 0.125 * 16), at(1.0 + 0.125 * 20));
  ASSERT_TRUE(expected);
  EXPECT_EQ(expected->rate_dps, 160.0);
}

TEST(EarlierRates, OfWindowsThatShareAHalfAreNotExpected) {
  EarlierRates rates;
  rates.add({at(1.0), 40.0, 2.0});
  EXPECT_FALSE(rates.expected(at(0.9), at(1.4)));
  EXPECT_TRUE(rates.expected(at(1.0), at(1.5)));
}

TEST(EarlierRates, AreExpectedTheLessTheLongerAgoTheyWereTold) {
  EarlierRates rates;
  rates.add({at(1.0), 40.0, 2.0});
  const auto soon = rates.expected(at(1.0), at(1.5)), late = rates.expected(at(4.0), at(4.5));
  ASSERT_TRUE(soon && late);
  EXPECT_EQ(late->rate_dps, soon->rate_dps);
  EXPECT_GT(soon->sigma_dps, 12.0);
  EXPECT_GT(late->sigma_dps, 85.0);
}

}  // namespace
}  // namespace thermorig::likelihood

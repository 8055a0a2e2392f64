// SPDX-License-Identifier: MIT
#include "estimators/odometer/start.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

TEST(RefusedScale, IsConfirmedByAStartOfOtherHalvesAlone) {
  RefusedScale refused;
  EXPECT_FALSE(refused.is_confirmed(1.073, 40.0));
  refused.refuse(1.073, 30.0);
  EXPECT_FALSE(refused.is_confirmed(1.073, 10.0));  // some of its halves are the same
  EXPECT_FALSE(refused.is_confirmed(1.085, 40.0));
  EXPECT_TRUE(refused.is_confirmed(1.072, 40.0));
}

TEST(RefusedScale, KeepsTheFirstOfThoseThatAreTheSame) {
  RefusedScale refused;
  refused.refuse(1.073, 30.0);
  refused.refuse(1.072, 60.0);
  EXPECT_TRUE(refused.is_confirmed(1.073, 40.0));
  refused.refuse(0.91, 80.0);
  EXPECT_FALSE(refused.is_confirmed(1.073, 90.0));
}

}  // namespace
}  // namespace thermorig::odometer

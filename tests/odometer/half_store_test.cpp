// SPDX-License-Identifier: MIT
#include "estimators/odometer/mosaic.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

TEST(HalfStore, ForgetsHalvesFromAnyPlaceOn) {
  HalfStore store;
  for (const double now_s : {1.0, 2.0, 3.0, 4.0}) store.add(HalfFrame(), now_s);
  store.forget(1, 2);
  ASSERT_EQ(store.count(), 2U);
  EXPECT_EQ(store.at(0).now_s, 1.0);
  EXPECT_EQ(store.at(1).now_s, 4.0);
}

}  // namespace
}  // namespace thermorig::odometer

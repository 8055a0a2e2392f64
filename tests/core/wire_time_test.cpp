// SPDX-License-Identifier: MIT
#include "thermorig/core/wire_time.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig {
namespace {

TEST(WireTime, IsTenBitsAByte) {
  EXPECT_NEAR(wire_time_s(1544, 115200), 0.13403, 1e-5);
  EXPECT_NEAR(wire_time_s(1544, 460800), 0.03351, 1e-5);
}

TEST(WireTime, IsZeroWhereTheLinkHasNoBaudRate) {
  EXPECT_EQ(wire_time_s(1544, 0), 0.0);
}

TEST(WireTime, IsShorterWhereTheLineIsFasterThanItsBaudRate) {
  EXPECT_LT(shortest_wire_time_s(1544, 115200), wire_time_s(1544, 115200) / 1.021);
  EXPECT_EQ(shortest_wire_time_s(1544, 0), 0.0);
}

TEST(LinkBudget, RefusesEightFramesASecondAt115200) {
  const LinkBudget slow = link_budget(1544, 8.0, 115200);
  EXPECT_FALSE(slow.fits());
  EXPECT_NEAR(slow.load, 1.0722, 1e-4);
  EXPECT_NEAR(slow.max_rate_hz, 7.461, 1e-3);
  EXPECT_TRUE(link_budget(1544, 8.0, 460800).fits());
}

TEST(LinkBudget, NamesTheSlowestUsualRateThatCarriesIt) {
  EXPECT_EQ(usual_baud_for(1544, 8.0), 230400U);
  EXPECT_EQ(usual_baud_for(1544, 64.0), 1000000U);
  EXPECT_FALSE(usual_baud_for(1544, 640.0));
}

TEST(LinkBudget, IsUnlimitedWithoutABaudRate) {
  const LinkBudget usb = link_budget(1544, 8.0, 0);
  EXPECT_TRUE(usb.fits());
  EXPECT_TRUE(std::isinf(usb.max_rate_hz));
}

}  // namespace
}  // namespace thermorig

// SPDX-License-Identifier: MIT
#include "estimators/odometer/heading_trust.h"

#include <gtest/gtest.h>

namespace thermorig::odometer {
namespace {

HalfResult used_at(double rate_dps) {
  return {.is_used = true, .is_judged = true, .rate_dps = rate_dps};
}

TEST(HeadingTrust, BelievesWhatASearchFoundAfterEightHalvesThatFit) {
  HeadingTrust trust;
  trust.begin_unproven(50.0, false);
  for (int i = 0; i < 7; ++i) trust.add(used_at(50.0));
  trust.add({.is_used = false, .is_judged = true, .rate_dps = 50.0});
  EXPECT_FALSE(trust.is_trusted());
  trust.add(used_at(50.0));
  EXPECT_TRUE(trust.is_trusted());
}

TEST(HeadingTrust, DoubtsWhatTheGyroContradictsUntilTwiceAsManyHalvesFitAtAnotherSpeed) {
  HeadingTrust trust;
  trust.begin_unproven(50.0, true);
  for (int i = 0; i < 100; ++i) trust.add(used_at(80.0));
  for (int i = 0; i < 15; ++i) trust.add(used_at(95.0));
  EXPECT_FALSE(trust.is_trusted());
  trust.add(used_at(95.0));
  EXPECT_TRUE(trust.is_trusted());
}

/// There a wrong time fits again.
TEST(HeadingTrust, DoesNotCountHalvesAtTheSpeedOfBeforeThoughItHasChangedMeanwhile) {
  HeadingTrust trust;
  trust.begin_unproven(50.0, true);
  trust.add({.is_used = false, .is_judged = true, .rate_dps = -50.0});
  for (int i = 0; i < 100; ++i) trust.add(used_at(50.0));
  EXPECT_FALSE(trust.is_trusted());
}

TEST(HeadingTrust, InAMapOfBeforeASlowRigsRestIsAnotherSpeed) {
  HeadingTrust slow, fast;
  slow.begin_in_map(20.0);
  fast.begin_in_map(100.0);
  for (int i = 0; i < 16; ++i) {
    slow.add(used_at(0.0));
    fast.add(used_at(70.0));
  }
  EXPECT_TRUE(slow.is_trusted());
  EXPECT_FALSE(fast.is_trusted());
}

TEST(HeadingTrust, ForgetsDoubtsWhereTheRunBeginsAnew) {
  HeadingTrust trust;
  trust.begin_unproven(50.0, true);
  trust.begin(20.0);
  EXPECT_TRUE(trust.is_trusted());
  EXPECT_FALSE(trust.has_changed_speed());
}

}  // namespace
}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
#include "io/web/mark_limit.h"

#include <gtest/gtest.h>

namespace thermorig::web {

using namespace std::chrono_literals;

namespace {

/// How many of these are taken, tried at one time.
int taken(MarkLimit& limit, MarkLimit::Time now, int tries) {
  int count = 0;
  for (int i = 0; i < tries; ++i) count += limit.take(now) ? 1 : 0;
  return count;
}

}  // namespace

TEST(MarkLimit, TakesSomeAtOnceAndThenOneAPeriod) {
  MarkLimit limit(10, 1s);
  const MarkLimit::Time begin{};
  EXPECT_EQ(taken(limit, begin, 100), 10);
  EXPECT_EQ(taken(limit, begin + 999ms, 100), 0);
  EXPECT_EQ(taken(limit, begin + 1s, 100), 1);
  EXPECT_EQ(taken(limit, begin + 2500ms, 100), 1);
  EXPECT_EQ(taken(limit, begin + 3s, 100), 1);
}

TEST(MarkLimit, WhoWaitsMaySetSomeAtOnceAgainButNoMore) {
  MarkLimit limit(10, 1s);
  const MarkLimit::Time begin{};
  EXPECT_EQ(taken(limit, begin, 100), 10);
  EXPECT_EQ(taken(limit, begin + 4s, 100), 4);
  EXPECT_EQ(taken(limit, begin + 24h, 100), 10);
}

TEST(MarkLimit, AFloodOfAnHourLeavesOneAPeriod) {
  MarkLimit limit(10, 1s);
  int count = 0;
  for (auto at = 0ms; at < 1h; at += 10ms) count += taken(limit, MarkLimit::Time(at), 2);
  EXPECT_EQ(count, 10 + 3599);
}

TEST(MarkLimit, TheSlowAreNeverRefused) {
  MarkLimit limit(1, 1s);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(limit.take(MarkLimit::Time(i * 1s))) << i;
}

}  // namespace thermorig::web

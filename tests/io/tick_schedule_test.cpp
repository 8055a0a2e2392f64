// SPDX-License-Identifier: MIT
#include "io/tick_schedule.h"

#include <gtest/gtest.h>

#include <vector>

namespace thermorig::io {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr HostTime begin{milliseconds(5000)};

TEST(TickSchedule, IsNeverDueBeforeAPeriodHasPassed) {
  TickSchedule schedule(milliseconds(10), begin);
  EXPECT_FALSE(schedule.take(begin));
  EXPECT_FALSE(schedule.take(begin + milliseconds(10) - nanoseconds(1)));
  EXPECT_TRUE(schedule.take(begin + milliseconds(10)));
  EXPECT_FALSE(schedule.take(begin + milliseconds(10))) << "twice";
  EXPECT_FALSE(schedule.take(begin + milliseconds(20) - nanoseconds(1)));
  EXPECT_TRUE(schedule.take(begin + milliseconds(20)));
}

TEST(TickSchedule, StaysAtWholePeriodsHoweverLateEachTickIs) {
  TickSchedule schedule(milliseconds(10), begin);
  for (int tick = 1; tick <= 1000; ++tick) {
    ASSERT_EQ(schedule.due(), begin + tick * milliseconds(10));
    ASSERT_TRUE(schedule.take(schedule.due() + milliseconds(tick % 10)));
  }
}

TEST(TickSchedule, LeavesOutTheTicksThatWereMissed) {
  TickSchedule schedule(milliseconds(10), begin);
  EXPECT_TRUE(schedule.take(begin + milliseconds(47)));
  EXPECT_EQ(schedule.due(), begin + milliseconds(50));
  EXPECT_FALSE(schedule.take(begin + milliseconds(48)));
  EXPECT_TRUE(schedule.take(begin + milliseconds(50)));
  EXPECT_EQ(schedule.due(), begin + milliseconds(60));
}

}  // namespace
}  // namespace thermorig::io

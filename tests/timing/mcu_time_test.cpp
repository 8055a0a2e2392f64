// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/device_time.h"

#include <gtest/gtest.h>

#include "support/at_s.h"

namespace thermorig::timing {
namespace {

constexpr ClockProperties of_firmware{
    .tick_s = 1e-6, .wrap_ticks = std::uint64_t{1} << 32U, .rate_error_max = 0.02};

TEST(McuTime, FollowsTheCounterWhereItDoesNotWrap) {
  McuTime time(of_firmware);
  EXPECT_EQ(time.unwrap(1'000'000, at_s(50)), 1'000'000);
  EXPECT_EQ(time.unwrap(1'010'000, at_s(50.01)), 1'010'000);
}

TEST(McuTime, GoesOnWhereTheCounterWraps) {
  McuTime time(of_firmware);
  time.unwrap(0xFFFFFF00U, at_s(10));
  EXPECT_EQ(time.unwrap(0x00002610U, at_s(10.01)), 0x100002610LL);
  EXPECT_EQ(time.unwrap(0x00004D20U, at_s(10.02)), 0x100004D20LL);
}

TEST(McuTime, CountsTheWrapsOfALongSilence) {
  McuTime time(of_firmware);
  time.unwrap(5'000'000, at_s(0));
  const std::int64_t two_wraps_us = 2LL * 4'294'967'296LL + 3'000'000;
  EXPECT_EQ(time.unwrap(8'000'000, at_s(static_cast<double>(two_wraps_us) * 1e-6)), 5'000'000 + two_wraps_us);
}

TEST(McuTime, StartsANewEpochAfterAReset) {
  McuTime time(of_firmware);
  time.unwrap(90'000'000, at_s(100));
  EXPECT_EQ(time.unwrap(20'000, at_s(102)), 20'000);
  EXPECT_EQ(time.unwrap(30'000, at_s(102.01)), 30'000);
}

TEST(McuTime, StartsANewEpochAfterAResetThatLooksLikeAStepForward) {
  McuTime time(of_firmware);
  time.unwrap(1'000'000, at_s(10));
  time.unwrap(0xFFFFFFF0U, at_s(10 + 4293.967));
  EXPECT_EQ(time.unwrap(5'000'000, at_s(10 + 4293.967 + 60)), 5'000'000);
}

TEST(McuTime, ToleratesAClockThatIsTwoPercentSlowOverAnHour) {
  McuTime time(of_firmware);
  time.unwrap(0, at_s(0));
  EXPECT_EQ(time.unwrap(3'528'000'000U, at_s(3600)), 3'528'000'000LL);
}

TEST(McuTime, ToleratesTelemetryThatComesInOneGo) {
  McuTime time(of_firmware);
  time.unwrap(1'000'000, at_s(10));
  EXPECT_EQ(time.unwrap(1'500'000, at_s(10)), 1'500'000);  // read late, with the one before
}

TEST(McuTime, GoesByWhatTheClockIsSaidToBe) {
  McuTime time({.tick_s = 1e-3, .wrap_ticks = 65536, .rate_error_max = 0.02});  // 16 bits of milliseconds
  time.unwrap(65'535'000, at_s(0));
  EXPECT_EQ(time.unwrap(9'000, at_s(0.010)), 65'545'000);
  McuTime exact({.tick_s = 1e-6, .wrap_ticks = std::uint64_t{1} << 32U, .rate_error_max = 1e-4});
  exact.unwrap(0, at_s(0));
  EXPECT_EQ(exact.unwrap(990'000'000, at_s(1000)), 990'000'000) << "1 % slow: another epoch";
  EXPECT_EQ(exact.unwrap(5, at_s(1000.01)), 5);
}

TEST(McuTime, JumpsByMoreThanAWrapOverAnAbsence) {
  McuTime time(of_firmware);
  time.restart();  // nothing was seen before
  EXPECT_EQ(time.unwrap(1'000'000, at_s(10)), 1'000'000);
  time.restart();
  constexpr std::int64_t wrap = 1LL << 32U;
  const std::int64_t after = time.unwrap(1'500'000, at_s(10.5));  // as if it had gone on all the time
  EXPECT_EQ(after, 2 * wrap + 1'500'000);
  EXPECT_EQ(time.unwrap(1'600'000, at_s(10.6)), after + 100'000);
  time.restart();
  EXPECT_GT(time.unwrap(0, at_s(20)), after + wrap);
}

}  // namespace
}  // namespace thermorig::timing

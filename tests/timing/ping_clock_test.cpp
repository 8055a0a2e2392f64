// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/ping_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string_view>

#include "ping_link.h"
#include "thermorig/core/statistics.h"

namespace thermorig::timing {
namespace ping_clock {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_us = 1'000'000;

/// What a live clock says of each telemetry message as it comes.
struct Live {
  std::vector<std::int64_t> mcu_us;
  std::vector<TimeEstimate> times;
  std::size_t epochs = 0;
  double median_width_s = 0.0;
};

Live live(const PingTraffic& traffic) {
  PingClock clock(servo_link());
  Live said;
  std::vector<float> widths_s;
  feed(clock, traffic, [&](std::int64_t mcu_us) {
    const auto time = clock.at(mcu_us);
    if (!time) return;
    said.mcu_us.push_back(mcu_us);
    said.times.push_back(*time);
    widths_s.push_back(time->earlier_s + time->later_s);
  });
  said.epochs = clock.epochs().size();
  if (!widths_s.empty()) said.median_width_s = double{lower_quantile(widths_s, 0.5)};
  return said;
}

/// Nobody who hears no future knows that a host's clock begins to be slewed. All else holds.
TEST(PingClock, BoundsFollowAClockThatWandersMoreThanItsProfileSays) {
  for (const Wandering& one : wandering)
    for (const double timer_s : {0.0, 0.016}) {
      const PingTraffic wild = wild_traffic(one, timer_s);
      const Live said = live(wild);
      EXPECT_EQ(said.epochs, 1U) << one.name << timer_s;
      const bool is_sudden = std::string_view(one.name).starts_with("slewed");
      EXPECT_LE(violations_on(said.mcu_us, said.times, wild.clock, one.ahead_s),
                is_sudden ? static_cast<int>(said.times.size()) / 50 : 0)
          << one.name << timer_s;
    }
}

TEST(PingClock, BoundsOfAQuartzHoldAndAreNarrow) {
  const PingTraffic cdc = traffic({.seed = 5, .duration_s = 390.0});
  const Live said = live(cdc);
  EXPECT_EQ(violations_on(said.mcu_us, said.times, cdc.clock, [](double) { return 0.0; }), 0);
  EXPECT_LE(said.median_width_s, 0.25e-3);
}

TEST(PingClock, KnowsNothingBeforeTheFirstExchange) {
  PingClock clock(servo_link());
  EXPECT_FALSE(clock.at(0).has_value());
  EXPECT_THAT(clock.epochs(), IsEmpty());
  clock.feed(sent_at(1000, host_time_ns(2'000'000)));
  EXPECT_FALSE(clock.at(1000).has_value());
  clock.feed({2000, host_time_ns(2'000'000), 2500, host_time_ns(4'000'000)});
  EXPECT_TRUE(clock.at(2500).has_value());
}

TEST(PingClock, StaysWithinItsBoundsFromThePastAlone) {
  const PingTraffic cdc = traffic({.seed = 18, .duration_s = 1000.0});
  PingClock clock(servo_link());
  std::vector<std::int64_t> asked;
  std::vector<TimeEstimate> times;
  feed(clock, cdc, [&](std::int64_t mcu_us) {
    const auto time = clock.at(mcu_us);
    if (!time) return;
    asked.push_back(mcu_us);
    times.push_back(*time);
  });
  EXPECT_EQ(judge(asked, times, cdc.clock, 0.0).violations, 0);
  const ServoScore settled = judge(asked, times, cdc.clock, 30.0);
  EXPECT_LE(settled.p99_s, 0.15e-3);
  EXPECT_LE(settled.widest_s, 0.6e-3);
  EXPECT_EQ(clock.epochs().size(), 1U);
}

TEST(PingClock, BeginsAnEpochAfterAReset) {
  PingTraffic cdc = traffic({.seed = 19, .duration_s = 20.0});
  append(cdc, traffic({.seed = 20, .duration_s = 20.0}), 30.0, 0);
  PingClock clock(servo_link());
  feed(clock, cdc, [](std::int64_t) {});
  ASSERT_EQ(clock.epochs().size(), 2U);
  EXPECT_THAT(clock.epochs()[1].reason, HasSubstr("was reset"));
  const auto time = clock.at(19 * second_us);
  ASSERT_TRUE(time.has_value());
  EXPECT_NEAR(to_s(time->time.time_since_epoch()), 49.0, 0.01);
}

TEST(PingClock, IgnoresAnAnswerThatWasSentBeforeItsPing) {
  const PingTraffic cdc = traffic({.seed = 21, .duration_s = 20.0});
  PingClock clock(servo_link());
  feed(clock, cdc, [](std::int64_t) {});
  const auto before = clock.at(20 * second_us);
  clock.feed({25 * second_us, host_time_ns(0), 24 * second_us, host_time_ns(1)});
  const auto after = clock.at(20 * second_us);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->time, after->time);
  EXPECT_EQ(before->later_s, after->later_s);
}

TEST(PingClock, SurvivesHostileValues) {
  const HostileTraffic hostile = hostile_traffic();
  PortProfile link = servo_link();
  for (const double wander_ppm : {6.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    link.wander_ppm = wander_ppm;
    PingClock clock(link);
    for (std::size_t i = 0; i < hostile.sent.size(); ++i) {
      clock.feed(hostile.exchanges[i]);
      clock.feed(hostile.sent[i]);
      clock.at(hostile.values[i % hostile.values.size()]);
    }
    EXPECT_GE(clock.epochs().size(), 1U);
  }
}

}  // namespace ping_clock
}  // namespace thermorig::timing

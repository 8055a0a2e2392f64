// SPDX-License-Identifier: MIT
#include "thermorig/fit/clocks/recorded_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "thermorig/core/statistics.h"
#include "timing/ping_link.h"

namespace thermorig::fit {

using namespace timing;

namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_us = 1'000'000;

ServoScore judge(const PingTraffic& traffic, const PingFit& fit, double from_s = 0.0) {
  return judge(traffic.mcu_us, fit.times, traffic.clock, from_s);
}

PingFit fit(const PingTraffic& traffic) {
  return fit_pings(traffic.mcu_us, traffic.exchanges, traffic.sent, servo_link());
}

TEST(PingFit, KeepsAQuartzWithinATenthOfAMillisecondAndItsBoundForTenThousandSeconds) {
  const PingTraffic cdc = traffic({.seed = 5, .duration_s = 10'000.0});
  const ServoScore score = judge(cdc, fit(cdc));
  EXPECT_LE(score.p99_s, 0.1e-3);
  EXPECT_LE(score.widest_s, 0.25e-3);
  EXPECT_EQ(score.violations, 0);
}

TEST(PingFit, BoundsHoldBehindALatencyTimer) {
  for (const double timer_s : {0.016, 0.001}) {
    const PingTraffic ftdi = traffic({.seed = 6,
                                      .duration_s = 600.0,
                                      .latency_timer_s = timer_s,
                                      .dither_s = timer_s > 0.01 ? 0.020 : 0.003});
    const ServoScore score = judge(ftdi, fit(ftdi));
    EXPECT_EQ(score.violations, 0);
    EXPECT_LE(score.widest_s, 3e-3);
  }
}

TEST(PingFit, ReportsRateLatenessAndKnots) {
  const PingTraffic cdc = traffic({.seed = 7, .duration_s = 300.0});
  const ClockReport report = fit(cdc).report;
  EXPECT_EQ(report.method, "two-way");
  EXPECT_NEAR(report.rate_hz, 100.0, 0.01);
  const double true_skew = (cdc.clock.host_s(290.0) - cdc.clock.host_s(10.0)) / 280.0 - 1.0;
  EXPECT_NEAR(report.skew_ppm, true_skew * 1e6, 1.5);
  EXPECT_LE(report.wander_ppm, 8.0);
  EXPECT_GE(report.late_p50_us, 50.0);
  EXPECT_GE(report.late_max_us, 2000.0);
  EXPECT_LE(report.bound_median_us, report.bound_us);
  ASSERT_EQ(report.epochs.size(), 1U);
  EXPECT_THAT(report.epochs[0].reason, IsEmpty());
  EXPECT_THAT(report.gaps, IsEmpty());
  ASSERT_GT(report.knots.size(), 100U);
  for (const ClockKnot& knot : report.knots)
    EXPECT_NEAR(knot.offset_s,
                cdc.clock.host_s(to_s(knot.time.time_since_epoch())) - to_s(knot.time.time_since_epoch()),
                0.2e-3);
}

TEST(PingFit, MarksLostTelemetryAsAGap) {
  PingTraffic cdc = traffic({.seed = 8, .duration_s = 60.0});
  const auto lost = [](std::int64_t mcu_us) { return mcu_us > 20 * second_us && mcu_us < 25 * second_us; };
  std::erase_if(cdc.mcu_us, lost);
  std::erase_if(cdc.sent, [&](const PingBound& stamp) { return lost(stamp.send_us); });
  const PingFit result = fit(cdc);
  ASSERT_EQ(result.report.gaps.size(), 1U);
  EXPECT_EQ(result.report.gaps[0].missing, 499U);
  EXPECT_EQ(judge(cdc, result).violations, 0);
}

TEST(PingFit, BeginsAnEpochWhereTheServoWasReset) {
  PingTraffic cdc = traffic({.seed = 9, .duration_s = 60.0});
  const PingTraffic after = traffic({.seed = 10, .duration_s = 60.0});
  const std::size_t before_count = cdc.mcu_us.size();
  append(cdc, after, 75.0, 0);
  const PingFit result = fit(cdc);
  ASSERT_EQ(result.report.epochs.size(), 2U);
  EXPECT_THAT(result.report.epochs[1].reason,
              HasSubstr("was reset: its time ran back from 60.0 s to 500.00 ms"));
  const std::vector<TimeEstimate> second(result.times.begin() + static_cast<std::ptrdiff_t>(before_count),
                                         result.times.end());
  std::vector<TimeEstimate> shifted;
  for (TimeEstimate time : second) {
    time.time -= from_s(75.0);
    shifted.push_back(time);
  }
  const ServoScore score = judge(after.mcu_us, shifted, after.clock, 0.0);
  EXPECT_EQ(score.violations, 0);
  EXPECT_LE(score.widest_s, 0.4e-3);
}

TEST(PingFit, TellsASuspendedHost) {
  PingTraffic cdc = traffic({.seed = 11, .duration_s = 60.0});
  append(cdc, traffic({.seed = 11, .duration_s = 60.0}), 60.0, 100 * second_us);
  const PingFit result = fit(cdc);
  ASSERT_EQ(result.report.epochs.size(), 2U);
  EXPECT_THAT(result.report.epochs[1].reason, HasSubstr("host was suspended"));
  EXPECT_THAT(result.report.epochs[1].reason, HasSubstr("gained 40.0 s"));
}

TEST(PingFit, TellsAServoThatLostTime) {
  PingTraffic cdc = traffic({.seed = 12, .duration_s = 60.0});
  append(cdc, traffic({.seed = 12, .duration_s = 60.0}), 64.0, 60 * second_us);
  const PingFit result = fit(cdc);
  ASSERT_EQ(result.report.epochs.size(), 2U);
  EXPECT_THAT(result.report.epochs[1].reason, HasSubstr("clock lost 4.0 s"));
  // Telemetry between the break and the first answers after it belongs to the epoch after it.
  const auto at_break = std::find(cdc.mcu_us.begin(), cdc.mcu_us.end(), 61'200'000) - cdc.mcu_us.begin();
  const double host_s = to_s(result.times.at(static_cast<std::size_t>(at_break)).time.time_since_epoch());
  EXPECT_NEAR(host_s, 65.2, 0.01);
}

TEST(PingFit, TellsAWrongBaudRate) {
  const PingTraffic far_off = traffic({.seed = 13, .duration_s = 60.0, .wire_error_s = 0.004});
  ASSERT_GE(fit(far_off).report.epochs.size(), 2U);
  EXPECT_THAT(fit(far_off).report.epochs[1].reason, HasSubstr("faster than the wire allows"));
  EXPECT_THAT(fit(far_off).report.epochs[1].reason, HasSubstr("the baud rate is not 250000"));
  const PingTraffic off = traffic({.seed = 13, .duration_s = 60.0, .wire_error_s = 0.0004});
  ASSERT_GE(fit(off).report.epochs.size(), 2U);
  EXPECT_THAT(fit(off).report.epochs[1].reason, HasSubstr("baud rate"));
}

TEST(PingFit, BoundsFollowAClockThatWandersMoreThanItsProfileSays) {
  for (const Wandering& one : wandering)
    for (const double timer_s : {0.0, 0.016}) {
      const PingTraffic wild = wild_traffic(one, timer_s);
      const PingFit result = fit(wild);
      EXPECT_EQ(result.report.epochs.size(), 1U) << one.name << timer_s;
      EXPECT_GT(result.report.bound_wander_ppm, servo_link().wander_ppm) << one.name << timer_s;
      EXPECT_LE(result.report.needed_wander_ppm, result.report.bound_wander_ppm) << one.name << timer_s;
      EXPECT_EQ(violations_on(wild.mcu_us, result.times, wild.clock, one.ahead_s), 0) << one.name << timer_s;
    }
}

/// Violations behind a latency timer, whose answers bound a clock the least.
int violations_behind_a_timer(std::uint64_t seed, const Wandering& one) {
  const PingTraffic wild = on_host(
      traffic({.seed = seed, .duration_s = 390.0, .latency_timer_s = 0.016, .dither_s = 0.020}), one.ahead_s);
  return violations_on(wild.mcu_us, fit(wild).times, wild.clock, one.ahead_s);
}

TEST(PingFit, BoundsHoldWhereADriftingClockBegins) {
  EXPECT_EQ(violations_behind_a_timer(1, wandering[2]), 0);
  EXPECT_EQ(violations_behind_a_timer(8, wandering[3]), 0);
}

TEST(PingFit, BoundsAreNotPressedTogetherByAWaveThatTheyBarelyHold) {
  EXPECT_EQ(violations_behind_a_timer(6, wandering[4]), 0);
}

TEST(PingFit, BoundsHoldWhereAClockJumpsBetweenTwoAnswers) {
  for (const double jump_s : {-0.05, 0.05, 0.4}) {
    const PingTraffic quiet = traffic({.seed = 23, .duration_s = 60.0, .ping_s = 1.0});
    const auto jumped_s = [jump_s](double at_s) { return at_s > 30.3 ? jump_s : 0.0; };
    PingTraffic jumps = on_host(quiet, jumped_s);
    const PingFit result = fit(jumps);
    EXPECT_GE(result.report.epochs.size(), 2U) << jump_s;
    for (std::size_t i = 0; i < result.times.size(); ++i) {
      const double host_s = jumps.clock.host_s(1e-6 * static_cast<double>(jumps.mcu_us[i]));
      if (std::abs(host_s - 30.3) < 0.005) continue;  // on its way while the clock jumped
      const double late_s = to_s(result.times[i].time.time_since_epoch()) - host_s - jumped_s(host_s);
      EXPECT_LE(late_s, static_cast<double>(result.times[i].earlier_s) + 2e-9) << jump_s << " " << host_s;
      EXPECT_LE(-late_s, static_cast<double>(result.times[i].later_s) + 2e-9) << jump_s << " " << host_s;
    }
  }
}

TEST(PingFit, SaysWhichWanderWasChecked) {
  const ClockReport quiet = fit(traffic({.seed = 14, .duration_s = 300.0})).report;
  EXPECT_EQ(quiet.bound_wander_ppm, servo_link().wander_ppm);
  EXPECT_EQ(quiet.needed_wander_ppm, servo_link().wander_ppm);
  const PingTraffic wrong_baud = traffic({.seed = 13, .duration_s = 60.0, .wire_error_s = 0.0004});
  EXPECT_EQ(fit(wrong_baud).report.bound_wander_ppm, 0.0);  // nothing explains it: no proof
  EXPECT_EQ(fit(wrong_baud).report.needed_wander_ppm, std::numeric_limits<double>::infinity());
}

/// Answers that may come 16 ms late do not tell a clock that is as good as its profile says from a worse one.
TEST(PingFit, SaysWhatWasNeededApartFromWhatSlowAnswersCouldNotTell) {
  const LinkOptions slow{.seed = 14, .duration_s = 300.0, .latency_timer_s = 0.016, .dither_s = 0.020};
  const ClockReport report = fit(traffic(slow)).report;
  EXPECT_EQ(report.needed_wander_ppm, servo_link().wander_ppm);
  EXPECT_GT(report.bound_wander_ppm, servo_link().wander_ppm);
}

TEST(PingFit, SaysWhatAClockNeededThatWandersMore) {
  for (const Wandering& one : wandering) {
    const PingTraffic wild = on_host(traffic({.seed = 14, .duration_s = 600.0}), one.ahead_s);
    EXPECT_GT(fit(wild).report.needed_wander_ppm, servo_link().wander_ppm) << one.name;
  }
}

TEST(PingFit, LeavesOutSingleMessagesThatFitNoClock) {
  PingTraffic cdc = traffic({.seed = 15, .duration_s = 60.0});
  for (std::size_t i = 40; i + 1 < cdc.exchanges.size(); i += 50) {
    cdc.exchanges[i].receive_us = i % 100 == 40 ? 4'000'000'000 : 17;
    cdc.exchanges[i].send_us = cdc.exchanges[i].receive_us + 1000;
  }
  const PingFit result = fit(cdc);
  EXPECT_EQ(result.report.epochs.size(), 1U);
  EXPECT_EQ(judge(cdc, result).violations, 0);
}

TEST(PingFit, IsOneWayWithoutAnyAnswer) {
  PingTraffic cdc = traffic({.seed = 16, .duration_s = 60.0});
  cdc.exchanges.clear();
  const PingFit result = fit(cdc);
  EXPECT_EQ(result.report.method, "one-way");
  for (const TimeEstimate& time : result.times)
    EXPECT_NEAR(time.earlier_s + time.later_s, servo_link().largest_constant_delay_s, 1e-6);
}

TEST(PingFit, SaysNothingWithoutABound) {
  const std::vector<std::int64_t> asked{0, 10'000, 20'000};
  const PingFit result = fit_pings(asked, {}, {}, servo_link());
  ASSERT_EQ(result.times.size(), 3U);
  EXPECT_EQ(result.times[0].uncertainty_s, std::numeric_limits<float>::infinity());
  EXPECT_THAT(result.report.method, IsEmpty());
  EXPECT_THAT(fit_pings({}, {}, {}, servo_link()).times, IsEmpty());
}

TEST(PingFit, SurvivesHostileValues) {
  const HostileTraffic hostile = hostile_traffic();
  PortProfile link = servo_link();
  for (const double wander_ppm : {6.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    link.wander_ppm = wander_ppm;
    EXPECT_EQ(fit_pings(hostile.values, hostile.exchanges, hostile.sent, link).times.size(),
              hostile.values.size());
  }
}

TEST(PingFit, TakesTwoMessages) {
  const std::vector<std::int64_t> asked{1'000'000};
  const std::vector<PingBound> one{{1'000'000, host_time_ns(0), 1'001'000, host_time_ns(3'000'000)}};
  const PingFit result = fit_pings(asked, one, {}, servo_link());
  ASSERT_EQ(result.times.size(), 1U);
  EXPECT_NEAR(to_s(result.times[0].time.time_since_epoch()), 0.001, 0.0001);
  EXPECT_NEAR(result.times[0].later_s, 0.001, 0.0001);
}

TEST(PingFit, AnswersForTimesThatWereNotSent) {
  const PingTraffic cdc = traffic({.seed = 17, .duration_s = 60.0});
  std::vector<std::int64_t> asked;
  for (std::int64_t mcu_us = 2 * second_us; mcu_us < 58 * second_us; mcu_us += 12'345)
    asked.push_back(mcu_us);
  const PingFit result = fit_pings(asked, cdc.exchanges, cdc.sent, servo_link());
  EXPECT_EQ(judge(asked, result.times, cdc.clock, 0.0).violations, 0);
}

}  // namespace
}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/ping_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>

#include "ping_link.h"
#include "thermorig/core/statistics.h"

namespace thermorig::timing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t second_us = 1'000'000;

PortProfile servo_link() {
  return ServoProfile{}.link;
}

struct ServoScore {
  double p99_s = 0.0;
  double widest_s = 0.0;
  int violations = 0;
};

/// Errors and bounds of `times` from `from_s` on.
ServoScore judge(const std::vector<std::int64_t>& mcu_us, const std::vector<TimeEstimate>& times,
                 const QuartzClock& clock, double from_s) {
  std::vector<double> errors_s;
  ServoScore score;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double mcu_s = 1e-6 * static_cast<double>(mcu_us[i]);
    if (mcu_s < from_s) continue;
    const double late_s = 1e-9 * static_cast<double>(to_ns(times[i].time)) - clock.host_s(mcu_s);
    errors_s.push_back(std::abs(late_s));
    score.widest_s = std::max(score.widest_s, static_cast<double>(times[i].earlier_s + times[i].later_s));
    score.violations += late_s > static_cast<double>(times[i].earlier_s) + 2e-9 ||
                        -late_s > static_cast<double>(times[i].later_s) + 2e-9;
  }
  std::sort(errors_s.begin(), errors_s.end());
  score.p99_s = errors_s.empty() ? 1.0 : errors_s[errors_s.size() * 99 / 100];
  return score;
}

ServoScore judge(const PingTraffic& traffic, const PingFit& fit, double from_s = 0.0) {
  return judge(traffic.mcu_us, fit.times, traffic.clock, from_s);
}

PingFit fit(const PingTraffic& traffic) {
  return fit_pings(traffic.mcu_us, traffic.exchanges, traffic.sent, servo_link());
}

/// Everything of a second recording after a first one, its host times shifted by `host_shift_s` and its
/// micro-controller's by `mcu_shift_us`.
void append(PingTraffic& to, const PingTraffic& more, double host_shift_s, std::int64_t mcu_shift_us) {
  const HostDuration host_shift = from_s(host_shift_s);
  for (const std::int64_t mcu_us : more.mcu_us) to.mcu_us.push_back(mcu_us + mcu_shift_us);
  for (const SentStamp& stamp : more.sent)
    to.sent.push_back({stamp.send_us + mcu_shift_us, stamp.not_after + host_shift});
  for (const PingExchange& exchange : more.exchanges)
    to.exchanges.push_back({exchange.receive_us + mcu_shift_us, exchange.not_before + host_shift,
                            exchange.send_us + mcu_shift_us, exchange.not_after + host_shift});
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
  std::erase_if(cdc.sent, [&](const SentStamp& stamp) { return lost(stamp.send_us); });
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

/// The same traffic on a host whose clock runs off by `ahead_s`(time) from the true one.
template <typename Ahead>
PingTraffic on_host(PingTraffic traffic, Ahead ahead_s) {
  const auto shown = [&](HostTime time) { return time + from_s(ahead_s(to_s(time.time_since_epoch()))); };
  for (SentStamp& stamp : traffic.sent) stamp.not_after = shown(stamp.not_after);
  for (PingExchange& exchange : traffic.exchanges) {
    exchange.not_before = shown(exchange.not_before);
    exchange.not_after = shown(exchange.not_after);
  }
  return traffic;
}

/// Clocks against which the micro-controller's wanders far more than a quartz does: the host's is slewed for
/// two minutes in four, or the micro-controller has a resonator that warms up, or one in a draught.
struct Wandering {
  const char* name;
  double (*ahead_s)(double at_s);
};

const std::array<Wandering, 5> wandering{{
    {"slewed forward", [](double at_s) { return slewed_s(at_s, 500e-6) - at_s; }},
    {"slewed back", [](double at_s) { return slewed_s(at_s, -500e-6) - at_s; }},
    {"warms up", [](double at_s) { return 300e-6 * 120.0 * (1.0 - std::exp(-at_s / 120.0)); }},
    {"cools down", [](double at_s) { return -300e-6 * 120.0 * (1.0 - std::exp(-at_s / 120.0)); }},
    {"waves", [](double at_s) { return 40e-6 * 60.0 / 6.283 * std::sin(6.283 * at_s / 60.0); }},
}};

/// Violations of the bounds, by the host's own clock.
int violations_on(const std::vector<std::int64_t>& mcu_us, const std::vector<TimeEstimate>& times,
                  const QuartzClock& clock, double (*ahead_s)(double)) {
  int violations = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double true_s = clock.host_s(1e-6 * static_cast<double>(mcu_us[i]));
    const double late_s = to_s(times[i].time.time_since_epoch()) - true_s - ahead_s(true_s);
    violations += late_s > static_cast<double>(times[i].earlier_s) + 2e-9 ||
                  -late_s > static_cast<double>(times[i].later_s) + 2e-9;
  }
  return violations;
}

/// Ten minutes of it, behind a latency timer or none.
PingTraffic wild_traffic(const Wandering& one, double timer_s) {
  const LinkOptions options{
      .seed = 14, .duration_s = 600.0, .latency_timer_s = timer_s, .dither_s = timer_s > 0.0 ? 0.020 : 0.003};
  return on_host(traffic(options), one.ahead_s);
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
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const std::vector<std::int64_t> values{least, most, 0, -1, 4'294'967'295, least, 1, most, most};
  std::vector<PingExchange> exchanges;
  std::vector<SentStamp> sent;
  for (const std::int64_t a : values)
    for (const std::int64_t b : values) {
      exchanges.push_back({a, host_time_ns(b), b, host_time_ns(a)});
      sent.push_back({a, host_time_ns(b)});
    }
  PortProfile link = servo_link();
  for (const double wander_ppm : {6.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    link.wander_ppm = wander_ppm;
    EXPECT_EQ(fit_pings(values, exchanges, sent, link).times.size(), values.size());
    PingClock clock(link);
    for (std::size_t i = 0; i < sent.size(); ++i) {
      clock.exchange(exchanges[i]);
      clock.sent(sent[i]);
      clock.at(values[i % values.size()]);
    }
    EXPECT_GE(clock.epochs().size(), 1U);
  }
}

TEST(PingFit, TakesTwoMessages) {
  const std::vector<std::int64_t> asked{1'000'000};
  const std::vector<PingExchange> one{{1'000'000, host_time_ns(0), 1'001'000, host_time_ns(3'000'000)}};
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

TEST(PingClock, KnowsNothingBeforeTheFirstExchange) {
  PingClock clock(servo_link());
  EXPECT_FALSE(clock.at(0).has_value());
  EXPECT_THAT(clock.epochs(), IsEmpty());
  clock.sent({1000, host_time_ns(2'000'000)});
  EXPECT_FALSE(clock.at(1000).has_value());
  clock.exchange({2000, host_time_ns(2'000'000), 2500, host_time_ns(4'000'000)});
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
  clock.exchange({25 * second_us, host_time_ns(0), 24 * second_us, host_time_ns(1)});
  const auto after = clock.at(20 * second_us);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->time, after->time);
  EXPECT_EQ(before->later_s, after->later_s);
}

}  // namespace
}  // namespace thermorig::timing

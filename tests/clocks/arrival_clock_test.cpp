// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "timing/recorded_stream.h"

namespace thermorig::fit {

using namespace timing;

namespace {

using simulation::UsbLink;

/// Errors of the final clock, and how they lie to what it says of itself.
struct Score {
  ErrorSizes errors;
  double normalised = 0.0;  // sum of squares over the stated uncertainty
  int outside = 0;          // of the bounds
};

void judge(const RecordedStream& stream, const ArrivalClock& clock, Score& score) {
  constexpr double float_s = 1e-7;  // bounds are stored as float
  ASSERT_EQ(clock.times.size(), stream.spans.size());
  for (std::size_t i = 0; i < clock.times.size(); ++i) {
    const TimeEstimate& time = clock.times[i];
    const double error_s = to_s(time.time - stream.sample_time[i]);
    score.errors.add(error_s);
    score.normalised += std::pow(error_s / static_cast<double>(time.uncertainty_s), 2);
    score.outside += error_s > time.earlier_s + float_s || -error_s > time.later_s + float_s;
  }
}

Score pooled(Device device, const TestLink& link) {
  Score score;
  for (const std::uint64_t seed : {1, 2}) {
    const RecordedStream stream = record_stream(device, link, seed, 90.0);
    const FittedStream fitted = fit_stream(stream);
    EXPECT_EQ(fitted.number, stream.index) << link.name << " seed " << seed;
    judge(stream, fitted.clock, score);
  }
  return score;
}

/// Gaps in the clock of a device that sends its own time, at 100 Hz and read at once.
std::vector<ClockGap> gaps_by_own_time(const std::vector<double>& device_s, double own_error_s = 0.0) {
  std::vector<LatestBegin> latest;
  for (const double time_s : device_s)
    latest.push_back({time_s, HostTime(from_s(5.0 + time_s)), false, 0.001, 0.0});
  std::vector<double> told_s = device_s;
  told_s[told_s.size() / 2] += own_error_s;
  latest[latest.size() / 2].device_s += own_error_s;
  return fit_arrivals(told_s, latest, PortProfile{}, 100.0).report.gaps;
}

std::vector<double> own_times(double jitter_s, double pause_s) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> stray_s(-jitter_s, jitter_s);
  std::vector<double> times_s{0.0};
  for (int i = 1; i < 2000; ++i)
    times_s.push_back(times_s.back() + 0.01 + stray_s(random) + (i == 1000 ? pause_s : 0.0));
  return times_s;
}

TEST(GapsByOwnTime, AreNotThePausesOfAnUnsteadyDevice) {
  for (const double jitter_s : {0.0, 0.002, 0.006})
    EXPECT_TRUE(gaps_by_own_time(own_times(jitter_s, 0.0)).empty());
  for (const double jitter_s : {0.0, 0.002, 0.006}) {
    const auto gaps = gaps_by_own_time(own_times(jitter_s, 0.05));
    ASSERT_EQ(gaps.size(), 1U) << jitter_s;
    EXPECT_NEAR(static_cast<double>(gaps[0].missing), 5.0, 1.0);
  }
}

TEST(GapsByOwnTime, HaveNoMoreRoomThanTheHostsTime) {
  std::uint64_t missing = 0;
  for (const ClockGap& gap : gaps_by_own_time(own_times(0.0, 0.0), 3600.0)) missing += gap.missing;
  EXPECT_LE(missing, 3U);
}

class EveryLink : public testing::TestWithParam<bool> {};

TEST_P(EveryLink, KeepsTheGyroWithinItsLimits) {
  for (const TestLink& link : links(GetParam())) {
    const Score score = pooled(Device::gyro, link);
    EXPECT_LE(score.errors.quantile(0.99), 1.2 * ms) << link.name;
    EXPECT_LE(score.errors.rms(), 0.5 * ms) << link.name;
    EXPECT_EQ(score.outside, 0) << link.name;
  }
}

TEST_P(EveryLink, KeepsTheCameraWithinItsLimits) {
  for (const TestLink& link : links(GetParam())) {
    const bool is_ftdi_1_ms = link.kind == UsbLink::ftdi && link.latency_timer_s < 0.002;
    const Score score = pooled(Device::camera, link);
    EXPECT_LE(score.errors.quantile(0.99), (is_ftdi_1_ms ? 1.0 : 0.6) * ms) << link.name;
    EXPECT_LE(score.errors.rms(), 0.5 * ms) << link.name;
    EXPECT_EQ(score.outside, 0) << link.name;
  }
}

INSTANTIATE_TEST_SUITE_P(ArrivalClock, EveryLink, testing::Bool(),
                         [](const auto& loaded) { return loaded.param ? "OfALoadedHost" : "OfAnIdleHost"; });

TEST(ArrivalClock, StatesAnUncertaintyThatIsOfTheSizeOfItsErrors) {
  for (const TestLink& link : {links(false)[0], links(true)[1]})
    for (const Device device : {Device::camera, Device::gyro}) {
      const Score score = pooled(device, link);
      const double mean = score.normalised / static_cast<double>(score.errors.count());
      EXPECT_GT(mean, 0.1) << link.name;
      EXPECT_LT(mean, 3.0) << link.name;
    }
}

TEST(ArrivalClock, LeavesAnOutageAsAGap) {
  const HostTime begin(from_s(30.0));
  const HostTime end(from_s(60.0));
  for (const TestLink& link : links(true)) {
    const RecordedStream stream =
        record_stream(Device::camera, link, 3, 90.0, {{Device::camera, begin, end}});
    const FittedStream fitted = fit_stream(stream);
    EXPECT_EQ(fitted.number, stream.index) << link.name;
    const auto& gaps = fitted.clock.report.gaps;
    ASSERT_EQ(gaps.size(), 1U) << link.name;
    EXPECT_NEAR(to_s(gaps[0].begin - begin), 0.0, 0.3);
    EXPECT_NEAR(to_s(gaps[0].end - end), 0.0, 0.3);
    EXPECT_NEAR(static_cast<double>(gaps[0].missing), 30.0 * 7.84, 2.0);
    ErrorSizes errors;
    for (std::size_t i = 0; i < stream.spans.size(); ++i) {
      EXPECT_TRUE(fitted.clock.times[i].time < begin || fitted.clock.times[i].time > end - from_s(0.1));
      if (stream.sample_time[i] > end - from_s(0.1))
        errors.add(to_s(fitted.clock.times[i].time - stream.sample_time[i]));
    }
    EXPECT_LE(errors.largest(), 1.2 * ms) << link.name;
    EXPECT_EQ(fitted.clock.report.epochs.size(), 1U);
  }
}

TEST(ArrivalClock, ReportsRateSkewLatenessAndKnots) {
  const RecordedStream stream = record_stream(Device::camera, links(false)[2], 1, 60.0);
  const ClockReport report = fit_stream(stream).clock.report;
  EXPECT_EQ(report.method, "one-way");
  EXPECT_NEAR(report.rate_hz, 8.0 * 0.98, 8.0 * 0.001);
  EXPECT_NEAR(report.skew_ppm, 1e6 * (1.0 / 0.98 - 1.0), 1000.0);
  EXPECT_GT(report.wander_ppm, 1.0);
  EXPECT_LT(report.wander_ppm, 500.0);
  EXPECT_GT(report.late_p50_us, 100.0);
  EXPECT_GE(report.late_p95_us, report.late_p50_us);
  EXPECT_GE(report.late_max_us, report.late_p95_us);
  EXPECT_GE(report.bound_us, report.bound_median_us);
  EXPECT_EQ(report.largest_constant_delay_s, stream.link.largest_constant_delay_s);
  ASSERT_FALSE(report.knots.empty());
  EXPECT_LE(report.knots.size(), 61U);
  for (std::size_t i = 1; i < report.knots.size(); ++i)
    EXPECT_GT(report.knots[i].time, report.knots[i - 1].time);
}

TEST(ArrivalClock, TakesOffTheLatency) {
  const RecordedStream stream = record_stream(Device::gyro, links(false)[0], 1, 10.0);
  RecordedStream later = stream.without([](std::size_t) { return false; }, false);
  later.link.latency_s = 0.004;
  const auto times = fit_stream(stream).clock.times;
  const auto shifted = fit_stream(later).clock.times;
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(to_s(times[i].time - shifted[i].time), 0.004, 2e-9);
}

/// A device with a time of its own: `count` messages a 10 ms, read a little late, each one an inequality.
struct OwnTime {
  std::vector<double> device_s;
  std::vector<LatestBegin> latest;
  std::vector<double> true_s;

  void add(double device, double host) {
    device_s.push_back(device);
    true_s.push_back(host);
    latest.push_back(
        {.device_s = device, .latest = HostTime(from_s(host + 0.02 * std::pow(wait_(random_), 2)))});
  }
  ArrivalClock fit() const { return fit_arrivals(device_s, latest, PortProfile{}, 100.0); }

 private:
  std::mt19937 random_{5};
  std::uniform_real_distribution<double> wait_;
};

TEST(ArrivalClock, BeginsANewEpochWhereTheDevicesTimeStepsBack) {
  OwnTime device;
  for (int i = 0; i < 2000; ++i) device.add(0.01 * i, 100.0 + 0.01 * i);
  for (int i = 0; i < 3000; ++i) device.add(0.5 + 0.01 * i, 123.0 + 0.010001 * i);
  const ArrivalClock clock = device.fit();
  ASSERT_EQ(clock.report.epochs.size(), 2U);
  EXPECT_TRUE(clock.report.epochs[0].reason.empty());
  EXPECT_FALSE(clock.report.epochs[1].reason.empty());
  EXPECT_NEAR(to_s(clock.report.epochs[1].begin.time_since_epoch()), 123.0, 0.002);
  for (std::size_t i = 0; i < device.true_s.size(); ++i)
    EXPECT_NEAR(to_s(clock.times[i].time.time_since_epoch()), device.true_s[i], 0.0015) << i;
}

TEST(ArrivalClock, FollowsATimeOfItsOwnThatIsNotSteady) {
  OwnTime device;
  double at_s = 0.0;
  for (int i = 0; i < 3000; ++i) {
    at_s += i % 7 == 0 ? 0.05 : 0.01;
    device.add(at_s, 50.0 + at_s);
  }
  const ArrivalClock clock = device.fit();
  for (std::size_t i = 0; i < device.true_s.size(); ++i)
    EXPECT_NEAR(to_s(clock.times[i].time.time_since_epoch()), device.true_s[i], 0.001) << i;
}

bool is_sound(const TimeEstimate& time) {
  return std::isfinite(time.uncertainty_s) && time.earlier_s >= 0.0F && time.later_s >= 0.0F;
}

TEST(ArrivalClock, SurvivesNoneOneAndTwoMessages) {
  EXPECT_TRUE(fit_arrivals({}, {}, PortProfile{}, 100.0).times.empty());
  const std::vector<LatestBegin> latest{{.device_s = 0.0, .latest = HostTime(from_s(7.0))},
                                        {.device_s = 0.01, .latest = HostTime(from_s(7.01))}};
  const std::vector<double> device_s{0.0, 0.01};
  for (const std::size_t count : {1, 2}) {
    const auto clock =
        fit_arrivals(std::span(device_s).first(count), std::span(latest).first(count), PortProfile{}, 100.0);
    ASSERT_EQ(clock.times.size(), count);
    EXPECT_NEAR(to_s(clock.times[0].time.time_since_epoch()), 7.0, 0.002);
    EXPECT_TRUE(is_sound(clock.times[0]));
    EXPECT_EQ(clock.report.epochs.size(), 1U);
  }
}

TEST(ArrivalClock, SaysNothingWhereNothingWasRead) {
  const std::vector<double> device_s{0.0, 0.01, 0.02};
  const auto clock = fit_arrivals(device_s, {}, PortProfile{}, 100.0);
  ASSERT_EQ(clock.times.size(), 3U);
  EXPECT_TRUE(clock.report.method.empty());
  EXPECT_GT(clock.times[0].uncertainty_s, 1000.0F);
}

TEST(ArrivalClock, SurvivesEqualTimesTimesThatRunBackwardsAndNoNumbers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<double>> devices{
      {0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
      {5.0, 4.0, 3.0, 2.0, 1.0, 0.0},
      {nan, nan, nan, nan, nan, nan},
      {nan, 0.01, nan, 0.02, std::numeric_limits<double>::infinity(), 0.03},
      {-1e300, 1e300, 0.0, 1e8, 1e8, -1e8}};
  for (const auto& device_s : devices)
    for (const double step_s : {0.0, 0.01, -0.01}) {
      std::vector<LatestBegin> latest;
      for (std::size_t i = 0; i < device_s.size(); ++i)
        latest.push_back({device_s[i], HostTime(from_s(10.0 + step_s * static_cast<double>(i)))});
      const auto clock = fit_arrivals(device_s, latest, PortProfile{}, 100.0);
      ASSERT_EQ(clock.times.size(), device_s.size());
      for (const TimeEstimate& time : clock.times) EXPECT_TRUE(is_sound(time));
    }
}

TEST(ArrivalClock, SurvivesTimesFromTheEndsOfTheClock) {
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const std::vector<double> device_s{0.0, 1e-300, 0.1, 0.2, 9e8};
  for (const auto& ns : std::vector<std::vector<std::int64_t>>{
           {least, least, 0, most, most}, {most, 0, least, most, least}, {0, 1'000'000'000, 1, 2, 3}}) {
    RawStream received;
    const std::vector<std::uint8_t> bytes(10);
    std::vector<StreamSpan> spans;
    for (std::size_t i = 0; i < ns.size(); ++i) {
      received.append(bytes, host_time_ns(ns[i]));
      spans.push_back({10 * i, 10 * i + 10});
    }
    const auto latest = latest_begins(received, spans, device_s, 9600);
    const auto clock = fit_arrivals(device_s, latest, PortProfile{}, 100.0);
    ASSERT_EQ(clock.times.size(), 5U);
    for (const TimeEstimate& time : clock.times) EXPECT_TRUE(is_sound(time));
    EXPECT_EQ(number_messages(earliest_proofs(received, spans, 9600), {}, 100.0).size(), 5U);
  }
}

TEST(LatestBegins, TakesTheWireTimeUpToTheChunksEndOffItsArrival) {
  RawStream received;
  const std::vector<std::uint8_t> bytes(40);
  received.append(std::span(bytes).first(15), HostTime(from_s(1.0)));  // ends within the second message
  received.append(std::span(bytes).first(5), HostTime(from_s(1.01)));  // ends with it
  received.append(std::span(bytes).first(3), HostTime(from_s(1.02)));  // ends between messages
  received.append(std::span(bytes).first(17), HostTime(from_s(0.5)));  // runs backwards: counts as equal
  const std::vector<StreamSpan> spans{{0, 10}, {10, 20}, {30, 40}};
  const std::vector<double> device_s{0.0, 0.1, 0.2};
  const auto latest = latest_begins(received, spans, device_s, 10000);  // 1 ms a byte
  ASSERT_EQ(latest.size(), 3U);
  EXPECT_EQ(latest[0].device_s, 0.1);
  EXPECT_NEAR(to_s(latest[0].latest.time_since_epoch()), 0.995, 1e-9);
  EXPECT_TRUE(latest[0].inside);
  EXPECT_NEAR(to_s(latest[1].latest.time_since_epoch()), 1.0, 1e-9);
  EXPECT_FALSE(latest[1].inside);
  EXPECT_EQ(latest[2].device_s, 0.2);
  EXPECT_NEAR(to_s(latest[2].latest.time_since_epoch()), 1.01, 1e-9);
}

TEST(EarliestProofs, LetALaterByteProveAnEarlierMessage) {
  RawStream received;
  const std::vector<std::uint8_t> bytes(30);
  received.append(std::span(bytes).first(10), HostTime(from_s(1.0)));
  received.append(std::span(bytes).first(10), HostTime(from_s(1.001)));
  const std::vector<StreamSpan> spans{{0, 10}, {10, 20}, {20, 30}};
  const auto proofs = earliest_proofs(received, spans, 10000);
  ASSERT_EQ(proofs.size(), 3U);
  EXPECT_NEAR(to_s(proofs[0].time_since_epoch()), 1.001 - shortest_wire_time_s(20, 10000), 1e-9);
  EXPECT_NEAR(to_s(proofs[1].time_since_epoch()), 1.001 - shortest_wire_time_s(10, 10000), 1e-9);
  EXPECT_EQ(proofs[2], HostTime::max());  // nothing of it came
}

/// Messages of 100 bytes at 10000 baud nominally, sent every 0.2 s over a line that is faster by
/// `baud_error`.
RawStream stream_over(double baud_error, std::vector<StreamSpan>& spans) {
  RawStream received;
  const std::vector<std::uint8_t> bytes(100);
  for (std::size_t i = 0; i < 200; ++i) {
    const double through_s = wire_time_s(bytes.size(), 10000) / (1.0 + baud_error);
    received.append(bytes, HostTime(from_s(0.2 * static_cast<double>(i) + through_s)));
    spans.push_back({100 * i, 100 * i + 100});
  }
  return received;
}

TEST(EarliestProofs, HoldOverALineThatIsFasterThanItsBaudRate) {
  std::vector<StreamSpan> spans;
  const RawStream received = stream_over(0.02, spans);
  const auto proofs = earliest_proofs(received, spans, 10000);
  for (std::size_t i = 0; i < proofs.size(); ++i)
    EXPECT_GE(to_s(proofs[i].time_since_epoch()), 0.2 * static_cast<double>(i));
}

TEST(ArrivalClock, BoundsHoldOverALineThatIsFasterOrSlowerThanItsBaudRate) {
  for (const double baud_error : {-0.02, 0.02}) {
    std::vector<StreamSpan> spans;
    const RawStream received = stream_over(baud_error, spans);
    std::vector<double> device_s;
    for (std::size_t i = 0; i < spans.size(); ++i) device_s.push_back(0.2 * static_cast<double>(i));
    PortProfile link;
    link.largest_constant_delay_s = 0.0;
    const auto clock = fit_arrivals(device_s, latest_begins(received, spans, device_s, 10000), link, 5.0);
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const double late_s = to_s(clock.times[i].time.time_since_epoch()) - device_s[i];
      EXPECT_LE(late_s, static_cast<double>(clock.times[i].earlier_s)) << baud_error;
      EXPECT_LE(-late_s, static_cast<double>(clock.times[i].later_s)) << baud_error;
    }
  }
}

TEST(ArrivalClock, FollowsAHostsClockThatIsSlewed) {
  const auto host_s = [](double at_s) {  // 500 ppm ahead, for two minutes in four
    const double cycles = std::floor(at_s / 240.0);
    return 100.0 + at_s + 500e-6 * (120.0 * cycles + std::min(at_s - 240.0 * cycles, 120.0));
  };
  std::mt19937_64 random(3);
  std::exponential_distribution<double> late_s(1.0 / 0.5e-3);
  std::vector<double> device_s;
  std::vector<LatestBegin> latest;
  for (int i = 0; i < 60'000; ++i) {
    device_s.push_back(0.01 * i);
    latest.push_back({.device_s = 0.01 * i,
                      .latest = HostTime(from_s(host_s(0.01 * i) + late_s(random))),
                      .wire_s = 0.001});
  }
  const auto clock = fit_arrivals(device_s, latest, PortProfile{}, 100.0);
  EXPECT_GT(clock.report.bound_wander_ppm, PortProfile{}.wander_ppm);
  EXPECT_EQ(clock.report.needed_wander_ppm, clock.report.bound_wander_ppm);
  for (std::size_t i = 0; i < device_s.size(); ++i) {
    const double error_s = to_s(clock.times[i].time.time_since_epoch()) - host_s(device_s[i]);
    ASSERT_LE(error_s, static_cast<double>(clock.times[i].earlier_s)) << device_s[i];
    ASSERT_LE(-error_s, static_cast<double>(clock.times[i].later_s)) << device_s[i];
    ASSERT_LE(std::abs(error_s), 6e-3) << device_s[i];
  }
}

TEST(ArrivalClock, SaysWhetherNothingExplainsWhatCameOrNothingWasChecked) {
  const auto needed_ppm = [](double wander_ppm, double faster_from_half) {
    std::vector<double> device_s;
    std::vector<LatestBegin> latest;
    double host_s = 100.0;
    for (int i = 0; i < 12'000; ++i) {
      host_s += 0.01 * (i < 6'000 ? 1.0 : 1.0 + faster_from_half);
      device_s.push_back(0.01 * i);
      latest.push_back({.device_s = 0.01 * i, .latest = HostTime(from_s(host_s)), .wire_s = 0.001});
    }
    PortProfile link;
    link.wander_ppm = wander_ppm;
    return fit_arrivals(device_s, latest, link, 100.0).report.needed_wander_ppm;
  };
  EXPECT_EQ(needed_ppm(100.0, 0.0), 100.0);
  EXPECT_EQ(needed_ppm(100.0, 0.02), std::numeric_limits<double>::infinity());
  EXPECT_EQ(needed_ppm(0.0, 0.0), 0.0);
}

TEST(ArrivalClock, KeepsToTheProfilesWanderWhereThatExplainsWhatCame) {
  for (const TestLink& link : links(true)) {
    const RecordedStream stream = record_stream(Device::gyro, link, 31, 60.0);
    EXPECT_EQ(fit_stream(stream).clock.report.bound_wander_ppm, stream.link.wander_ppm) << link.name;
  }
}

}  // namespace
}  // namespace thermorig::fit

// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "ping_link.h"
#include "recorded_stream.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/timing/link_timing.h"

namespace thermorig::timing {
namespace {

/// Errors from `begin_s` to `end_s` of the recording.
ErrorSizes errors(const RecordedStream& stream, const std::vector<Stamp>& stamps, double begin_s,
                  double end_s = 1e9) {
  ErrorSizes sizes;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double at_s = to_s(stream.sample_time[i] - stream.sample_time[0]);
    if (at_s >= begin_s && at_s < end_s) sizes.add(to_s(stamps[i].time - stream.sample_time[i]));
  }
  return sizes;
}

void expect_in_order(const std::vector<Stamp>& stamps) {
  for (std::size_t i = 1; i < stamps.size(); ++i) ASSERT_GE(stamps[i].time, stamps[i - 1].time) << i;
}

/// Even the fastest byte waits, for a USB frame, for the reader, on a link that listens for silence: on
/// average that is taken off, and what is left is what is stated.
TEST(LiveClock, IsGoodAfterTenSecondsOnEveryLink) {
  PerDevice<RunningStatistics> late_s, sigmas2;
  for (const bool loaded : {false, true})
    for (const TestLink& link : links(loaded))
      for (const Device device : {Device::camera, Device::gyro}) {
        ErrorSizes pooled;
        for (const std::uint64_t seed : {1, 2}) {
          const RecordedStream stream = record_stream(device, link, seed, 30.0);
          const auto stamps = stamp_stream(stream, stream.nominal_rate_hz);
          expect_in_order(stamps);
          for (std::size_t i = 0; i < stamps.size(); ++i) {
            if (stream.sample_time[i] - stream.sample_time[0] <= from_s(10.0)) continue;
            const double off_s = to_s(stamps[i].time - stream.sample_time[i]);
            pooled.add(off_s);
            late_s[device].add(off_s);
            sigmas2[device].add(std::pow(off_s / double{stamps[i].uncertainty_s}, 2));
          }
        }
        EXPECT_LE(pooled.quantile(0.99), 1.5 * ms) << link.name << (loaded ? " loaded" : " idle");
      }
  for (const Device device : {Device::camera, Device::gyro}) {
    EXPECT_NEAR(late_s[device].mean(), 0.0, 0.25 * ms) << name_of(device);
    EXPECT_NEAR(std::sqrt(sigmas2[device].mean()), 0.9, 0.4) << name_of(device);
  }
}

TEST(LiveClock, BeginsNoWorseThanTheProofsAlone) {
  const RecordedStream stream = record_stream(Device::gyro, links(false)[0], 2, 12.0);
  const auto stamps = stamp_stream(stream, stream.nominal_rate_hz);
  const auto alone = stamp_stream(stream, 0.0);
  EXPECT_LE(errors(stream, stamps, 0.0, 3.0).rms(), errors(stream, alone, 0.0, 3.0).rms());
  EXPECT_LE(errors(stream, stamps, 3.0, 10.0).quantile(0.99), 3.0 * ms);
}

TEST(LiveClock, KeepsItsBounds) {
  for (const TestLink& link : links(true)) {
    const RecordedStream stream = record_stream(Device::gyro, link, 7, 40.0);
    const auto stamps = stamp_stream(stream, stream.nominal_rate_hz);
    for (std::size_t i = 0; i < stamps.size(); ++i)
      EXPECT_GE(stamps[i].time + from_s(stamps[i].later_s) + from_s(1e-7), stream.sample_time[i]);
    for (std::size_t i = stamps.size() / 2; i < stamps.size(); ++i)
      EXPECT_LE(stamps[i].time - from_s(stamps[i].earlier_s), stream.sample_time[i]) << link.name;
  }
}

TEST(LiveClock, NeedsNoMoreThanAHintOfTheRate) {
  const RecordedStream stream = record_stream(Device::camera, links(false)[2], 3, 60.0);
  for (const double nominal_hz : {8.0, 4.0, 16.0})
    EXPECT_LE(errors(stream, stamp_stream(stream, nominal_hz), 15.0).quantile(0.99), 1.5 * ms) << nominal_hz;
}

TEST(LiveClock, GoesOnAfterAnOutage) {
  const std::vector<simulation::Outage> outage{
      {Device::camera, HostTime(from_s(20.0)), HostTime(from_s(50.0))}};
  for (const TestLink& link : links(true)) {
    const RecordedStream stream = record_stream(Device::camera, link, 2, 90.0, outage);
    const auto stamps = stamp_stream(stream, stream.nominal_rate_hz);
    expect_in_order(stamps);
    EXPECT_LE(errors(stream, stamps, 60.0).quantile(0.99), 2.0 * ms) << link.name;
    EXPECT_LE(errors(stream, stamps, 49.0, 60.0).largest(), 40.0 * ms) << link.name;
  }
}

TEST(LiveClock, CountsWhatWasDamagedAtOnce) {
  const RecordedStream whole = record_stream(Device::gyro, links(true)[0], 4, 40.0);
  const RecordedStream gyro = whole.without([](std::size_t i) { return i % 900 == 450; }, true);
  EXPECT_LE(errors(gyro, stamp_stream(gyro, 200.0), 10.0).quantile(0.99), 1.5 * ms);
}

TEST(LiveClock, RenumbersWhenTheStreamNeverCatchesUp) {
  const RecordedStream whole = record_stream(Device::gyro, links(true)[0], 4, 40.0);
  const RecordedStream gyro = whole.without([](std::size_t i) { return i >= 4000 && i < 4003; }, false);
  const auto stamps = stamp_stream(gyro, 200.0);
  expect_in_order(stamps);
  EXPECT_LE(errors(gyro, stamps, 22.0).quantile(0.99), 1.5 * ms);
}

/// Three messages in a chunk, and chunks that are read late by four periods on average.
TEST(LiveClock, TakesNoSlowReaderForALoss) {
  LinkTiming timing(PortProfile{.baud = 115200}, 200.0);
  std::mt19937 random(5);
  std::exponential_distribution<double> late_s(1.0 / 0.02);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const double begin_s = 1.0 + 0.005 * static_cast<double>(i);
    if (i % 3 == 0) timing.chunk(11 * (i + 3), HostTime(from_s(begin_s + 0.01 + 0.001 + late_s(random))));
    const Stamp stamp = timing.stamp({11 * i, 11 * (i + 1)});
    const double off_s = to_s(stamp.time.time_since_epoch()) - begin_s;
    EXPECT_LE(std::abs(off_s), i > 4000 ? 2.0 * ms : 1.0) << i;
  }
  EXPECT_EQ(timing.missing(), 0.0);
}

TEST(LiveClock, FallsBackToTheProofWhereThereIsNoSteadyRate) {
  std::mt19937 random(2);
  std::exponential_distribution<double> pause_s(50.0);
  LinkTiming timing(PortProfile{.baud = 115200}, 50.0);
  double at_s = 1.0;
  int by_proof = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    at_s += pause_s(random);
    timing.chunk(11 * (i + 1), HostTime(from_s(at_s + wire_time_s(11, 115200))));
    const Stamp stamp = timing.stamp({11 * i, 11 * (i + 1)});
    by_proof += i > 1000 && std::abs(to_s(stamp.time.time_since_epoch()) - at_s) < 1e-6;
  }
  EXPECT_GT(by_proof, 3500);
}

TEST(LiveClock, FollowsADevicesOwnTimeOverAReset) {
  LinkTiming timing(PortProfile{}, 100.0);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> late_s(0.0, 0.01);
  for (std::uint64_t i = 0; i < 6000; ++i) {
    const double host_s = 5.0 + 0.01 * static_cast<double>(i);
    const double device_s = 0.01 * static_cast<double>(i < 3000 ? i : i - 3000);
    timing.chunk(10 * (i + 1), HostTime(from_s(host_s + late_s(random))));
    const Stamp stamp = timing.stamp({10 * i, 10 * (i + 1)}, {.device_s = device_s});
    const double error_s = to_s(stamp.time.time_since_epoch()) - host_s;
    EXPECT_LE(std::abs(error_s), i % 3000 > 1000 ? 1.0 * ms : 12.0 * ms) << i;
  }
}

/// The fastest of these messages come as late as the link's setting has it: the bound has nothing to spare.
void expect_bounds_on_a_slewed_host(double rate_hz, double slew, std::uint64_t seed) {
  const PortProfile link;
  LinkTiming timing(link, rate_hz);
  std::mt19937_64 random(seed);
  std::exponential_distribution<double> late_s(1.0 / 0.5e-3);
  int before = 0, after = 0;
  const auto messages = static_cast<std::uint64_t>(500.0 * rate_hz);
  for (std::uint64_t i = 0; i < messages; ++i) {
    const double begun_s = slewed_s(5.0 + static_cast<double>(i) / rate_hz, slew);
    timing.chunk(10 * (i + 1), HostTime(from_s(begun_s + link.largest_constant_delay_s + late_s(random))));
    const Stamp stamp = timing.stamp({10 * i, 10 * (i + 1)});
    const double error_s = to_s(stamp.time.time_since_epoch()) - begun_s;
    before += error_s > static_cast<double>(stamp.earlier_s) + 1e-6;
    after += -error_s > static_cast<double>(stamp.later_s) + 1e-6;
  }
  EXPECT_EQ(before, 0) << rate_hz << " Hz, slew " << slew << ", seed " << seed;
  EXPECT_EQ(after, 0) << rate_hz << " Hz, slew " << slew << ", seed " << seed;
}

TEST(LiveClock, KeepsItsBoundsWhereTheHostsClockIsSlewed) {
  for (const double rate_hz : {8.0, 100.0, 200.0})
    for (const double slew : {-500e-6, 500e-6})
      for (const std::uint64_t seed : {3, 4, 5}) expect_bounds_on_a_slewed_host(rate_hz, slew, seed);
}

/// A camera 2 % slower than its name, which leaves out one half of ten, at the begin and two in a row too.
TEST(LiveClock, CountsWhatTheDeviceLeavesOut) {
  PortProfile link;
  link.wander_ppm = 1000.0;
  LinkTiming timing(link, 8.0);
  std::mt19937 random(5U);
  std::uint64_t sent = 0;
  int before = -1;
  double worst_s = 0.0;
  for (int turn = 0; turn < 800; ++turn) {
    const bool is_left_out = turn == 2 || turn == 4 || (turn > 5 && random() % 10 == 0);
    if (is_left_out) continue;
    const double time_s = 0.1275 * turn + 1e-3 * static_cast<double>(random() % 8) / 8.0;
    timing.chunk(10 * (sent + 1), HostTime(from_s(time_s)));
    const bool is_same_half = (turn - before) % 2 == 0;
    const Stamp stamp =
        timing.stamp({10 * sent, 10 * (sent + 1)}, {.lost_before = is_same_half, .device_s = {}});
    if (turn > 60) worst_s = std::max(worst_s, std::abs(to_s(stamp.time - HostTime(from_s(0.1275 * turn)))));
    before = turn;
    ++sent;
  }
  EXPECT_LT(worst_s, 5.0 * ms);
}

TEST(LiveClock, SurvivesTimesFromTheEndsOfTheClock) {
  LinkTiming timing(PortProfile{}, 100.0);
  HostTime before = HostTime::min();
  for (std::uint64_t i = 0; i < 500; ++i) {
    timing.chunk(10 * (i + 1), i < 100   ? HostTime::min()
                               : i < 300 ? HostTime(from_s(0.01 * static_cast<double>(i)))
                                         : HostTime::max());
    const Stamp stamp = timing.stamp({10 * i, 10 * (i + 1)});
    EXPECT_GE(stamp.time, before);
    before = stamp.time;
  }
}

TEST(LiveClock, SurvivesTimesThatAreNone) {
  LinkTiming timing(PortProfile{}, 100.0);
  HostTime before = HostTime::min();
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double device_s = i % 3 == 0 ? std::nan("") : i % 3 == 1 ? 1e300 : -1.0 * static_cast<double>(i);
    timing.chunk(10 * (i + 1), HostTime(from_s(i % 2 == 0 ? 3.0 : 2.0)));
    const Stamp stamp =
        timing.stamp({10 * i, 10 * (i + 1)}, {.lost_before = i % 5 == 0, .device_s = device_s});
    EXPECT_GE(stamp.time, before);
    before = stamp.time;
  }
}

}  // namespace
}  // namespace thermorig::timing

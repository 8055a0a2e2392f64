// SPDX-License-Identifier: MIT
// What the knobs of the micro-controller's clock, the links and the host's clock do to times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "frame_statistics.h"
#include "scripted_firmware.h"
#include "simulation/host_clock.h"
#include "simulation/servo_side.h"
#include "simulation/usb_link.h"
#include "support/at_s.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t one_ms = 1'000'000;

/// Of the micro-controller's clock against an honest one of the same seed, parts per million.
double rate_error_ppm(const ServoClockWorld& world, double from_s, double to_s) {
  McuClock honest(3), other(3, world);
  const auto elapsed_us = [&](McuClock& clock) {
    return static_cast<double>(clock.us_at(std::llround(to_s * 1e9)) -
                               clock.us_at(std::llround(from_s * 1e9)));
  };
  return 1e6 * (elapsed_us(other) / elapsed_us(honest) - 1.0);
}

TEST(ServoClockWorld, IsFastByItsConstantError) {
  EXPECT_NEAR(rate_error_ppm({.error_ppm = 5000.0}, 0.0, 100.0), 5000.0, 1.0);
  EXPECT_NEAR(rate_error_ppm({.error_ppm = -5000.0}, 500.0, 600.0), -5000.0, 1.0);
}

TEST(ServoClockWorld, WarmsUpWithinMinutes) {
  const ServoClockWorld world{.warm_up_ppm = 300.0};
  EXPECT_NEAR(rate_error_ppm(world, 0.0, 10.0), 288.0, 2.0);
  EXPECT_NEAR(rate_error_ppm(world, 120.0, 130.0), 106.0, 2.0);
  EXPECT_NEAR(rate_error_ppm(world, 1200.0, 1300.0), 0.0, 0.5);
}

TEST(ServoClockWorld, SwingsWithItsWave) {
  const auto swing_ppm = [](double period_s) {
    std::vector<double> rates;
    for (double time_s = 0.0; time_s < 1200.0; time_s += 10.0)
      rates.push_back(rate_error_ppm({.wave_ppm = 40.0, .wave_period_s = period_s}, time_s, time_s + 10.0));
    int crossings = 0;
    for (std::size_t i = 1; i < rates.size(); ++i) crossings += rates[i] * rates[i - 1] < 0.0 ? 1 : 0;
    EXPECT_NEAR(crossings, 2.0 * 1200.0 / period_s, 1.0);
    return std::pair{quantile_of(rates, 0.0), quantile_of(rates, 1.0)};
  };
  for (const double period_s : {100.0, 400.0}) {
    EXPECT_NEAR(swing_ppm(period_s).first, -40.0, 3.0);
    EXPECT_NEAR(swing_ppm(period_s).second, 40.0, 3.0);
  }
}

TEST(LinksWorld, ChangesTheTimeOfAByteByTheBaudError) {
  EXPECT_NEAR(UartLine(115200, 0.02).byte_ns(), UartLine(115200).byte_ns() / 1.02, 1e-6);
  EXPECT_NEAR(UartLine(115200, -0.02).byte_ns(), UartLine(115200).byte_ns() / 0.98, 1e-6);
}

/// Messages of two bytes, a random while apart.
std::vector<TimedByte> sparse_bytes() {
  std::vector<TimedByte> bytes;
  Random random(1, "sparse bytes");
  std::int64_t time_ns = 0;
  for (int i = 0; i < 4000; ++i) {
    bytes.push_back({time_ns += static_cast<std::int64_t>(random.uniform(2.0, 12.0) * one_ms), 1});
    bytes.push_back({time_ns += 10'000, 2});
  }
  return bytes;
}

std::vector<TimedBytes> reads_of(const LinksWorld& world, std::string_view port = "test") {
  const auto bytes = sparse_bytes();
  UsbPath path({UsbLink::cdc}, 1, port, world);
  path.push(bytes);
  return path.reads(bytes.back().time_ns + 1000 * one_ms);
}

/// How much later than in the honest world each message is read, in ms.
std::vector<double> delays_ms(const LinksWorld& world, std::string_view port = "test") {
  const auto read_times = [](const std::vector<TimedBytes>& reads) {
    std::vector<std::int64_t> times_ns;  // of each byte
    for (const TimedBytes& read : reads) times_ns.insert(times_ns.end(), read.bytes.size(), read.time_ns);
    return times_ns;
  };
  const auto honest = read_times(reads_of({}, port));
  const auto other = read_times(reads_of(world, port));
  EXPECT_EQ(honest.size(), other.size());
  std::vector<double> delays;
  for (std::size_t i = 0; i < std::min(honest.size(), other.size()); ++i)
    delays.push_back(1e-6 * static_cast<double>(other[i] - honest[i]));
  return delays;
}

TEST(LinksWorld, DelaysByItsHub) {
  const auto delays = delays_ms({.hub_delay_ms = 3.0});
  EXPECT_NEAR(median_of(delays), 3.0, 1e-6);
}

TEST(LinksWorld, JittersByItsHubTheSameOnAllPorts) {
  const auto delays = delays_ms({.hub_jitter_ms = 3.0});
  EXPECT_NEAR(median_of(delays), 1.5, 0.2);
  EXPECT_NEAR(quantile_of(delays, 0.9), 2.7, 0.2);
  const SharedBus bus({.hub_jitter_ms = 3.0}, 1), same({.hub_jitter_ms = 3.0}, 1);
  for (std::int64_t time_ns = 0; time_ns < 1000 * one_ms; time_ns += 7 * one_ms)
    EXPECT_EQ(bus.behind_hub_ns(time_ns), same.behind_hub_ns(time_ns));
}

/// The longest silences between two reads, by the time of their ends.
std::vector<double> silences_end_s(const LinksWorld& world, std::string_view port) {
  const auto reads = reads_of(world, port);
  std::vector<double> ends;
  for (std::size_t i = 1; i < reads.size(); ++i)
    if (reads[i].time_ns - reads[i - 1].time_ns > 60 * one_ms)
      ends.push_back(1e-9 * static_cast<double>(reads[i].time_ns));
  return ends;
}

TEST(LinksWorld, StallsAllPortsAtOnceAsOftenAsItSays) {
  const LinksWorld rare{.stall_ms = 200.0, .stall_interval_s = 6.0};
  const LinksWorld often{.stall_ms = 200.0, .stall_interval_s = 1.0};
  EXPECT_LE(silences_end_s({}, "one").size(), 2U);
  const auto one = silences_end_s(rare, "one");
  EXPECT_GE(one.size(), 2U);  // 28 s
  EXPECT_LT(2 * one.size(), silences_end_s(often, "one").size());
  EXPECT_GE(silences_end_s(often, "one").size(), 14U);
  const auto other = silences_end_s(often, "other");
  int together = 0;
  for (const double end_s : silences_end_s(often, "one"))
    together +=
        std::any_of(other.begin(), other.end(), [&](double at_s) { return std::abs(at_s - end_s) < 0.001; })
            ? 1
            : 0;
  EXPECT_GE(together, 12);
}

TEST(LinksWorld, AsksLateInItsFrames) {
  const auto delays = delays_ms({.frame_jitter_ms = 1.0});
  EXPECT_NEAR(median_of(delays), 0.5, 0.1);
  EXPECT_NEAR(quantile_of(delays, 0.9), 0.9, 0.15);
}

TEST(LinksWorld, ReadsLate) {
  const auto delays = delays_ms({.read_delay_ms = 10.0});
  EXPECT_GT(median_of(delays), 5.0);
  EXPECT_GT(quantile_of(delays, 0.95), 20.0);
}

class SlewedHostClock : public testing::TestWithParam<double> {};

TEST_P(SlewedHostClock, GoesForwardAndBackToTheSameInstant) {
  const HostClock clock(GetParam());
  std::int64_t before_ns = -1;
  for (std::int64_t rig_ns = 0; rig_ns < 1'000'000'000'000; rig_ns += 1'234'567'891) {
    const std::int64_t host_ns = clock.host_ns(rig_ns);
    EXPECT_GT(host_ns, before_ns);
    EXPECT_LE(clock.rig_ns(host_ns), rig_ns);
    EXPECT_GE(clock.rig_ns(host_ns), rig_ns - 2);
    EXPECT_LE(clock.host_ns(clock.rig_ns(host_ns)), host_ns);
    before_ns = host_ns;
  }
}

TEST_P(SlewedHostClock, IsSlewedForHalfOfTheTime) {
  const HostClock clock(GetParam());
  const auto gained_ns = [&](std::int64_t rig_s) {
    return static_cast<double>(clock.host_ns(rig_s * 1'000'000'000) - rig_s * 1'000'000'000);
  };
  EXPECT_NEAR(gained_ns(120), GetParam() * 120e3, 2.0);
  EXPECT_NEAR(gained_ns(240), GetParam() * 120e3, 2.0);
  EXPECT_NEAR(gained_ns(300), GetParam() * 180e3, 2.0);
}

INSTANTIATE_TEST_SUITE_P(Slews, SlewedHostClock, testing::Values(500.0, -500.0, 20.0, 0.0));

TEST(LinksWorld, BringsBytesOfASlewedHostLater) {
  const auto last_arrival = [](double slew_ppm) {
    auto config = default_rig(1, "kitchen");
    config.world.links.host_slew_ppm = slew_ppm;
    VirtualRig rig(config, std::make_unique<ScriptedFirmware>([](double) { return 0.0; }));
    const auto chunks = rig.advance(at_s(20.0));
    return std::pair{chunks.size(), to_s(chunks[1000].arrived - at_s(0.0))};
  };
  const auto [honest_chunks, honest_s] = last_arrival(0.0);
  const auto [slewed_chunks, slewed_s] = last_arrival(500.0);
  EXPECT_NEAR(slewed_s / honest_s, 1.0005, 1e-6);
  EXPECT_LE(slewed_chunks, honest_chunks);
}

TEST(LinksWorld, MovesBytesOfTheServoByItsBaudErrorBothWays) {
  const auto answers_end_ns = [](double baud_error) {
    World world;
    world.links.baud_error = baud_error;
    ServoSide side(std::make_unique<ScriptedFirmware>(nullptr), 250000, 1, world);
    side.send(std::vector<std::uint8_t>(100, 7), 0);
    return side.run_until(20 * one_ms).bytes.back().time_ns;
  };
  // 100 bytes there, and the last one back
  EXPECT_NEAR(static_cast<double>(answers_end_ns(0.02)), 101.0 * 40000.0 / 1.02, 2000.0);
  EXPECT_NEAR(static_cast<double>(answers_end_ns(-0.02)), 101.0 * 40000.0 / 0.98, 2000.0);
}

}  // namespace
}  // namespace thermorig::simulation

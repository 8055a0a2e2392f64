// SPDX-License-Identifier: MIT
#include "simulation/usb_link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "frame_statistics.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// Messages of `size` bytes every `period_ns` on a line of `baud`, numbered byte by byte.
std::vector<TimedByte> stream(std::size_t size, std::int64_t period_ns, std::uint32_t baud, int messages) {
  UartLine line(baud);
  std::vector<TimedByte> bytes;
  std::uint8_t value = 0;
  for (int i = 0; i < messages; ++i) {
    std::vector<std::uint8_t> message(size);
    for (auto& byte : message) byte = value++;
    line.send(message, i * period_ns, bytes);
  }
  return bytes;
}

std::vector<TimedBytes> carried(const std::vector<TimedByte>& bytes, const LinkConfig& link,
                                std::uint64_t seed = 1) {
  UsbPath path(link, seed, "test");
  path.push(bytes);
  return path.reads(bytes.back().time_ns + 1000 * ms);
}

/// How much later than the end of its stop bit each byte was read; checks that bytes come whole and in order.
std::vector<double> lateness_ms(const std::vector<TimedByte>& bytes, const std::vector<TimedBytes>& reads) {
  std::vector<double> late;
  std::size_t at = 0;
  std::int64_t before_ns = 0;
  for (const TimedBytes& read : reads) {
    EXPECT_GE(read.time_ns, before_ns);
    EXPECT_FALSE(read.bytes.empty());
    EXPECT_LE(read.bytes.size(), 4096U);
    before_ns = read.time_ns;
    for (const std::uint8_t value : read.bytes) {
      if (at == bytes.size()) ADD_FAILURE() << "more bytes than were sent";
      EXPECT_EQ(value, bytes[at].value);
      late.push_back(1e-6 * static_cast<double>(read.time_ns - bytes[at].time_ns));
      ++at;
    }
  }
  EXPECT_EQ(at, bytes.size());
  return late;
}

class EveryLink : public testing::TestWithParam<LinkConfig> {};

TEST_P(EveryLink, BringsEveryByteOnceInOrderAndNoneEarly) {
  for (const std::uint32_t baud : {0U, 115200U, 460800U}) {
    const auto bytes = stream(1544, 128 * ms, baud, 40);
    for (const double late : lateness_ms(bytes, carried(bytes, GetParam()))) ASSERT_GE(late, 0.0);
  }
}

TEST_P(EveryLink, GivesTheSameReadsHoweverOftenItIsAsked) {
  const auto bytes = stream(33, 10 * ms, 115200, 300);
  const auto at_once = carried(bytes, GetParam());
  UsbPath path(GetParam(), 1, "test");
  std::vector<TimedBytes> bit_by_bit;
  path.push(bytes);
  for (std::int64_t time_ns = 0; time_ns < bytes.back().time_ns + 1000 * ms; time_ns += 333'333)
    for (auto& read : path.reads(time_ns)) bit_by_bit.push_back(std::move(read));
  ASSERT_EQ(bit_by_bit.size(), at_once.size());
  for (std::size_t i = 0; i < at_once.size(); ++i) {
    EXPECT_EQ(bit_by_bit[i].time_ns, at_once[i].time_ns);
    EXPECT_EQ(bit_by_bit[i].bytes, at_once[i].bytes);
  }
}

std::string link_name(const testing::TestParamInfo<LinkConfig>& test) {
  const LinkConfig& link = test.param;
  const std::string kinds[] = {"Ftdi", "Ch340", "Cdc"};
  return kinds[static_cast<std::size_t>(link.kind)] +
         std::to_string(std::lround(link.latency_timer_s * 1e3)) + (link.loaded_host ? "Loaded" : "Idle");
}

INSTANTIATE_TEST_SUITE_P(
    Usb, EveryLink,
    testing::Values(LinkConfig{UsbLink::ftdi, 0.016, false}, LinkConfig{UsbLink::ftdi, 0.001, false},
                    LinkConfig{UsbLink::ftdi, 0.016, true}, LinkConfig{UsbLink::ch340, 0.0, false},
                    LinkConfig{UsbLink::ch340, 0.0, true}, LinkConfig{UsbLink::cdc, 0.0, false},
                    LinkConfig{UsbLink::cdc, 0.0, true}),
    link_name);

TEST(FtdiLink, HoldsSmallMessagesForUpToItsLatencyTimer) {
  // percentile.
  const auto bytes = stream(11, 5 * ms, 115200, 4000);
  const auto late = lateness_ms(bytes, carried(bytes, {UsbLink::ftdi, 0.016, false}));
  EXPECT_NEAR(median_of(late), 8.5, 1.5);
  EXPECT_GT(quantile_of(late, 0.9), 13.0);
  EXPECT_LT(quantile_of(late, 0.95), 18.0);
}

TEST(FtdiLink, WithAShortTimerIsFast) {
  const auto bytes = stream(11, 5 * ms, 115200, 4000);
  const auto late = lateness_ms(bytes, carried(bytes, {UsbLink::ftdi, 0.001, false}));
  EXPECT_LT(quantile_of(late, 0.9), 2.5);
}

TEST(FtdiLink, SendsTheBulkOfAFrameInRequestsAndItsEndWithTheTimer) {
  const auto bytes = stream(1544, 128 * ms, 460800, 100);
  const auto reads = carried(bytes, {UsbLink::ftdi, 0.016, false});
  const double reads_a_frame = static_cast<double>(reads.size()) / 100.0;
  EXPECT_GT(reads_a_frame, 3.5);  // 3 requests of 496 bytes and the timer's
  EXPECT_LT(reads_a_frame, 7.0);
}

TEST(Ch340Link, SendsPacketsOfThirtyTwoBytesAndFlushesAfterASilence) {
  const auto bytes = stream(44, 100 * ms, 9600, 50);
  const auto late = lateness_ms(bytes, carried(bytes, {UsbLink::ch340, 0.0, false}));
  EXPECT_LT(late[43], 5.0);               // the last byte waits for the silence only
  EXPECT_GT(late[0], 31.0 * 1.04 - 0.1);  // the first one for the 32nd
}

TEST(CdcLink, BringsBytesWithinAUsbFrame) {
  const auto bytes = stream(33, 10 * ms, 0, 1000);
  const auto late = lateness_ms(bytes, carried(bytes, {UsbLink::cdc, 0.0, false}));
  EXPECT_LT(quantile_of(late, 0.95), 1.6);
}

TEST(LoadedHost, StallsSomeReadsAndMergesWhatWaits) {
  const auto bytes = stream(1544, 128 * ms, 460800, 200);
  const auto idle = carried(bytes, {UsbLink::ch340, 0.0, false});
  const auto loaded = carried(bytes, {UsbLink::ch340, 0.0, true});
  const auto largest = [](const std::vector<TimedBytes>& reads) {
    std::size_t size = 0;
    for (const auto& read : reads) size = std::max(size, read.bytes.size());
    return size;
  };
  EXPECT_GT(quantile_of(lateness_ms(bytes, loaded), 0.9), 50.0);
  EXPECT_LT(quantile_of(lateness_ms(bytes, idle), 0.9), 10.0);
  EXPECT_LT(loaded.size(), idle.size());
  EXPECT_GT(largest(loaded), 1000U);
}

TEST(UsbPath, DiffersFromSeedToSeed) {
  const auto bytes = stream(11, 5 * ms, 115200, 100);
  EXPECT_NE(carried(bytes, {}, 1).front().time_ns, carried(bytes, {}, 2).front().time_ns);
}

TEST(UartLine, SendsTenBitsAByteOneAfterTheOther) {
  UartLine line(115200);
  std::vector<TimedByte> bytes;
  line.send(std::vector<std::uint8_t>(1544), 0, bytes);
  EXPECT_NEAR(static_cast<double>(bytes.back().time_ns) * 1e-6, 134.03, 0.01);
  EXPECT_NEAR(static_cast<double>(line.backlog_ns(100 * ms)) * 1e-6, 34.03, 0.01);
  line.send(std::vector<std::uint8_t>(1), 0, bytes);
  EXPECT_NEAR(static_cast<double>(bytes.back().time_ns) * 1e-6, 134.11, 0.01);
}

}  // namespace
}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/pipeline/timing/least_lateness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace thermorig::timing {
namespace {

constexpr std::uint32_t baud = 100000;  // 0.1 ms a byte

HostTime at_ms(double time_ms) {
  return HostTime(from_s(time_ms * 1e-3));
}
double in_ms(HostTime time) {
  return to_s(time.time_since_epoch()) * 1e3;
}
LinkTiming link(double latency_s = 0.0, std::uint32_t bits_per_s = baud) {
  return LinkTiming(PortProfile{.baud = bits_per_s, .latency_s = latency_s});
}

TEST(MessageReads, CountCutsOnlyWhereTheBaudRateSaysHowLongTheBytesTook) {
  const auto reads = [](double wire_s) {
    std::vector<LatestBegin> three(3);
    for (std::size_t i = 0; i < three.size(); ++i)
      three[i] = {.latest = at_ms(30.0 - 10.0 * static_cast<double>(i)), .inside = i < 2, .wire_s = wire_s};
    return message_reads(three);
  };
  EXPECT_EQ(reads(0.001).cuts, 2U);
  EXPECT_EQ(reads(0.001).least_cut, 1U);
  EXPECT_EQ(reads(0.0).cuts, 0U);
  EXPECT_EQ(reads(0.0).least, 2U);
}

TEST(LinkTiming, BoundsHoldOverALineThatIsFasterOrSlowerThanItsBaudRate) {
  for (const double baud_error : {-0.02, 0.02}) {
    LinkTiming timing = link();
    timing.chunk(1000, at_ms(100.0 / (1.0 + baud_error)));  // began at 0 ms
    const Stamp stamp = timing.stamp({0, 1000});
    EXPECT_GE(in_ms(stamp.time) + 1e3 * static_cast<double>(stamp.later_s), 0.0);
    EXPECT_LE(in_ms(stamp.time) - 1e3 * static_cast<double>(stamp.earlier_s), 0.0);
  }
}

TEST(LinkTiming, TakesOffTheWireTimeFromTheMessagesFirstByteToTheChunksLast) {
  LinkTiming timing = link();
  timing.chunk(50, at_ms(100));
  EXPECT_NEAR(in_ms(timing.stamp({10, 20}).time), 100.0 - 4.0, 1e-6);  // bytes 10..49
  EXPECT_NEAR(in_ms(timing.stamp({40, 50}).time), 100.0 - 1.0, 1e-6);
}

TEST(LinkTiming, UsesTheChunkThatBroughtTheLastByte) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(50));
  timing.chunk(30, at_ms(60));
  timing.chunk(90, at_ms(70));
  const Stamp stamp = timing.stamp({5, 20});
  EXPECT_NEAR(in_ms(stamp.time), 60.0 - 2.5, 1e-6);  // bytes 5..29
  EXPECT_EQ(stamp.arrival, at_ms(60));
}

TEST(LinkTiming, AMessageThatEndsWithItsChunkBelongsToThatChunk) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(50));
  timing.chunk(20, at_ms(60));
  EXPECT_EQ(timing.stamp({0, 10}).arrival, at_ms(50));
  EXPECT_EQ(timing.stamp({10, 20}).arrival, at_ms(60));
}

TEST(LinkTiming, TakesOffTheLatency) {
  LinkTiming timing = link(0.007);
  timing.chunk(10, at_ms(50));
  EXPECT_NEAR(in_ms(timing.stamp({0, 10}).time), 50.0 - 1.0 - 7.0, 1e-6);
}

TEST(LinkTiming, WithoutABaudRateTheTimeIsTheArrival) {
  LinkTiming timing = link(0.0, 0);
  timing.chunk(64, at_ms(50));
  EXPECT_EQ(timing.stamp({0, 32}).time, at_ms(50));
}

TEST(LinkTiming, NeverStampsAMessageBeforeTheOneBefore) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(100));  // the host stalled: two chunks are read in one go
  timing.chunk(110, at_ms(100));
  const Stamp first = timing.stamp({0, 10});
  const Stamp second = timing.stamp({10, 20});
  EXPECT_NEAR(in_ms(first.time), 99.0, 1e-6);
  EXPECT_EQ(second.time, first.time);  // by its own chunk alone it would be 90 ms
}

TEST(LinkTiming, AnArrivalThatRunsBackwardsCountsAsEqual) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(100));
  timing.chunk(20, at_ms(40));
  timing.chunk(30, at_ms(120));
  EXPECT_EQ(timing.stamp({0, 10}).arrival, at_ms(100));
  EXPECT_EQ(timing.stamp({10, 20}).arrival, at_ms(100));
  EXPECT_EQ(timing.stamp({20, 30}).arrival, at_ms(120));
}

TEST(LinkTiming, IsAsUncertainAsTheChunkCouldHaveWaited) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(100));
  timing.chunk(30, at_ms(110));   // 10 ms since the chunk before, 2 ms of it on the wire
  timing.chunk(130, at_ms(115));  // the line was busy all the time
  EXPECT_NEAR(timing.stamp({0, 10}).uncertainty_s, 0.016 / std::sqrt(12.0), 1e-6);  // nothing known yet
  EXPECT_NEAR(timing.stamp({10, 30}).uncertainty_s, 0.008 / std::sqrt(12.0), 1e-6);
  EXPECT_NEAR(timing.stamp({30, 130}).uncertainty_s, 0.0, 1e-6);
}

TEST(LinkTiming, APauseMakesItNoMoreUncertainThanTheLongestHold) {
  LinkTiming timing = link();
  timing.chunk(10, at_ms(100));
  timing.chunk(20, at_ms(9000));
  EXPECT_NEAR(timing.stamp({10, 20}).uncertainty_s, 0.016 / std::sqrt(12.0), 1e-6);
}

TEST(LinkTiming, KeepsItsChunksForAMessageThatEndsAFrameBack) {
  LinkTiming timing = link();
  timing.chunk(100, at_ms(10));
  for (std::uint64_t end = 101; end <= 1700; ++end)
    timing.chunk(end, at_ms(10.0 + 0.1 * static_cast<double>(end)));
  EXPECT_EQ(timing.stamp({0, 100}).arrival, at_ms(10));
}

TEST(LinkTiming, ForgetsChunksOutOfWhichNoMessageEverCame) {
  LinkTiming timing = link();
  timing.chunk(100, at_ms(1));
  const std::uint64_t far = 100 + LinkTiming::history_bytes + 10;
  timing.chunk(far, at_ms(50));
  timing.chunk(far + 10, at_ms(60));
  EXPECT_EQ(timing.stamp({0, 100}).arrival, at_ms(50));  // the oldest that is still known
}

TEST(LinkTiming, HoldsNoMessageAfterAnAbsenceAgainstChunksBeforeIt) {
  LinkTiming timing = link();
  timing.chunk(100, at_ms(100));
  timing.stamp({0, 100});
  timing.restart();
  timing.chunk(150, at_ms(5000));
  const auto stamp = timing.stamp({100, 150});
  EXPECT_EQ(stamp.arrival, at_ms(5000));
  EXPECT_NEAR(in_ms(stamp.time), 4995.0, 1e-6);
}

}  // namespace
}  // namespace thermorig::timing

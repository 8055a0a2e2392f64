// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <random>

#include "support/gyro_scanners.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "wire/scan.h"

namespace thermorig::test {
namespace {

using wire::GyroMessage;
using wire::witmotion_packet_bytes;

Scan<GyroMessage> scan_witmotion(ByteSpan bytes, Stream stream = Stream::goes_on) {
  return scan_any_chunking<GyroMessage>(witmotion_scanner(), bytes, stream);
}

/// A count whose bytes are those that a gyro packet begins with.
constexpr auto header_count = static_cast<std::int16_t>(witmotion::sync | (witmotion::type_gyro << 8));

/// The packet number `index` of a stream: its counts name it.
ByteVector numbered_packet(int index) {
  const auto packet = wire::witmotion_gyro_packet(
      {static_cast<std::int16_t>(index), static_cast<std::int16_t>(-index), header_count}, 25.5F);
  return {packet.begin(), packet.end()};
}

ByteVector numbered_packets(int first, int last) {
  ByteVector bytes;
  for (int i = first; i <= last; ++i) append(bytes, numbered_packet(i));
  return bytes;
}

std::vector<int> numbers_of(const Scan<GyroMessage>& scan) {
  std::vector<int> numbers;
  for (const GyroMessage& message : scan.messages) numbers.push_back(message.reading.counts[0]);
  return numbers;
}

TEST(WitmotionScanner, ConvertsCountsToDegreesPerSecond) {
  const auto packet = wire::witmotion_gyro_packet({16384, -16384, 1}, -12.34F);
  ByteVector bytes(packet.begin(), packet.end());
  append(bytes, packet);
  const auto scan = scan_witmotion(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  const GyroReading& reading = scan.messages[0].reading;
  EXPECT_FLOAT_EQ(reading.rate_dps[0], 1000.0F);
  EXPECT_FLOAT_EQ(reading.rate_dps[1], -1000.0F);
  EXPECT_FLOAT_EQ(reading.rate_dps[2], 2000.0F / 32768.0F);
  ASSERT_TRUE(reading.temp_c.has_value());
  EXPECT_FLOAT_EQ(*reading.temp_c, -12.34F);
  EXPECT_FALSE(reading.saturated);
  EXPECT_FALSE(reading.device_time_us.has_value());
}

TEST(WitmotionScanner, DeliversBothPacketsThatLockedIt) {
  const auto scan = scan_witmotion(numbered_packets(1, 2));
  EXPECT_EQ(numbers_of(scan), (std::vector<int>{1, 2}));
  EXPECT_EQ(scan.messages[0].span, (StreamSpan{0, 11}));
  EXPECT_FALSE(scan.messages[0].lost_before);
}

TEST(WitmotionScanner, FindsItsPlaceWhenItJoinsInsideAPacket) {
  ByteVector bytes = numbered_packets(1, 4);
  bytes.erase(bytes.begin(), bytes.begin() + 5);
  const auto scan = scan_witmotion(bytes);
  EXPECT_EQ(numbers_of(scan), (std::vector<int>{2, 3, 4}));
  EXPECT_TRUE(scan.messages[0].lost_before);
  EXPECT_FALSE(scan.messages[1].lost_before);
  EXPECT_EQ(scan.counters.bytes_skipped, 6U);
  EXPECT_EQ(scan.counters.bad_checksum, 0U);
}

TEST(WitmotionScanner, IsNotFooledByPacketsInsidePackets) {
  // Every word is a sync byte and the type of a gyro packet.
  ByteVector bytes;
  const auto packet =
      wire::witmotion_packet(witmotion::type_gyro, {header_count, header_count, header_count, header_count});
  for (int i = 0; i < 10; ++i) append(bytes, packet);
  for (std::size_t cut = 0; cut < witmotion_packet_bytes; ++cut) {
    const auto scan = scan_witmotion(ByteSpan(bytes).subspan(cut));
    EXPECT_EQ(scan.messages.size(), cut == 0 ? 10U : 9U);
    for (const GyroMessage& message : scan.messages) EXPECT_EQ(message.reading.counts[0], header_count);
  }
}

TEST(WitmotionScanner, LosesOnlyThePacketWithAFlippedBit) {
  for (std::size_t bit = 0; bit < 8 * witmotion_packet_bytes; ++bit) {
    ByteVector bytes = numbered_packets(1, 8);
    bytes[4 * witmotion_packet_bytes + bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    const auto scan = scan_witmotion(bytes);
    EXPECT_EQ(numbers_of(scan), (std::vector<int>{1, 2, 3, 4, 6, 7, 8})) << "bit " << bit;
    ASSERT_GT(scan.messages.size(), 4U);
    EXPECT_TRUE(scan.messages[4].lost_before);
    EXPECT_EQ(scan.counters.resyncs, 1U);
  }
}

TEST(WitmotionScanner, RecoversBehindLostAndDoubledBytes) {
  for (std::size_t at = 33; at < 44; ++at) {
    ByteVector lost = numbered_packets(1, 9);
    lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(at));
    EXPECT_EQ(numbers_of(scan_witmotion(lost)), (std::vector<int>{1, 2, 3, 5, 6, 7, 8, 9})) << at;

    ByteVector doubled = numbered_packets(1, 9);
    doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(at), doubled[at]);
    const auto numbers = numbers_of(scan_witmotion(doubled));
    const std::vector<int> tail(numbers.end() - 5, numbers.end());
    EXPECT_EQ(tail, (std::vector<int>{5, 6, 7, 8, 9})) << at;
  }
}

TEST(WitmotionScanner, KeepsTheGapInMindAcrossOtherPackets) {
  ByteVector bytes{0x00};
  const auto acceleration = wire::witmotion_packet(witmotion::type_acceleration, {0, 0, 2048, 2500});
  append(bytes, acceleration);
  append(bytes, numbered_packet(1));
  const auto scan = scan_witmotion(bytes);
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_TRUE(scan.messages[0].lost_before);
  EXPECT_EQ(scan.counters.replies, 1U);
}

TEST(WitmotionScanner, DoesNotTrustASinglePacketBehindDamage) {
  const ByteVector noise(7, 0x00);
  ByteVector bytes = noise;
  append(bytes, numbered_packet(66));  // alone at the start
  append(bytes, noise);
  append(bytes, numbered_packets(1, 3));
  append(bytes, noise);
  append(bytes, numbered_packet(77));  // alone once in step
  append(bytes, noise);
  append(bytes, numbered_packets(4, 6));
  const auto scan = scan_witmotion(bytes);
  EXPECT_EQ(numbers_of(scan), (std::vector<int>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(scan.messages[3].lost_before);
}

TEST(WitmotionScanner, TakesASinglePacketAtTheEndOfTheStream) {
  EXPECT_EQ(scan_witmotion(numbered_packet(5)).messages.size(), 0U);
  const auto alone = scan_witmotion(numbered_packet(5), Stream::ends);
  EXPECT_EQ(numbers_of(alone), (std::vector<int>{5}));
  EXPECT_EQ(alone.counters.bytes_in_messages, witmotion_packet_bytes);

  ByteVector cut_in_the_next = numbered_packets(5, 6);
  for (std::size_t left = witmotion_packet_bytes - 1; left > 0; --left) {
    cut_in_the_next.pop_back();
    const auto scan = scan_witmotion(cut_in_the_next, Stream::ends);
    EXPECT_EQ(numbers_of(scan), (std::vector<int>{5}));
    EXPECT_EQ(scan.counters.bytes_pending, left);
  }
  ByteVector before_garbage = numbered_packet(5);
  append(before_garbage, ByteVector{1, 2, 3});
  EXPECT_TRUE(scan_witmotion(before_garbage, Stream::ends).messages.empty());
}

TEST(WitmotionScanner, FindsNextToNothingInNoise) {
  // Two packets in a row: sync, type and sum twice over, less than once in a thousand million bytes.
  const auto scan = scan_witmotion(random_bytes(200000, 3));
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_EQ(scan.counters.bad_checksum, 0U);
  EXPECT_LT(scan.counters.bytes_pending, 2 * witmotion_packet_bytes);
}

TEST(WitmotionScanner, GivesEveryPacketThatIsFarEnoughFromDamage) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    ByteVector bytes;
    std::vector<int> expected;
    for (int burst = 0; burst < 8; ++burst) {
      append(bytes, random_bytes(random() % 40, random()));
      append(bytes, numbered_packets(100 * burst, 100 * burst + 9));
      // Noise ahead of a burst may look like the start of its first packets: those behind must be there.
      for (int i = 3; i < 9; ++i) expected.push_back(100 * burst + i);
    }
    const auto numbers = numbers_of(scan_witmotion(bytes));
    for (const int number : expected)
      EXPECT_EQ(std::count(numbers.begin(), numbers.end(), number), 1) << "seed " << seed;
  }
}

std::vector<std::uint8_t> packet_of(std::uint8_t type, std::uint8_t low, std::uint8_t high = 0) {
  std::vector<std::uint8_t> packet{0x55, type, low, high, 0, 0, 0, 0, 0, 0};
  packet.push_back(static_cast<std::uint8_t>(0x55 + type + low + high));
  return packet;
}

/// What a device answers among its readings, its register being `low` and `high`.
std::optional<double> bandwidth_answered(std::uint8_t low, std::uint8_t high = 0) {
  std::vector<std::uint8_t> bytes{0x12, 0x55};  // the end of another packet
  for (const auto& packet : {packet_of(0x52, 1), packet_of(0x5F, low, high), packet_of(0x52, 2)})
    bytes.insert(bytes.end(), packet.begin(), packet.end());
  return sensors::gyro_protocol("witmotion").bandwidth_hz(bytes);
}

TEST(WitmotionBandwidth, IsReadFromItsRegister) {
  EXPECT_EQ(bandwidth_answered(0), 256.0);
  EXPECT_EQ(bandwidth_answered(4), 20.0);
  EXPECT_EQ(bandwidth_answered(6), 5.0);
}

TEST(WitmotionBandwidth, IsNotMadeUp) {
  EXPECT_EQ(bandwidth_answered(7), std::nullopt);
  EXPECT_EQ(bandwidth_answered(4, 1), std::nullopt);
  const auto read = sensors::gyro_protocol("witmotion").bandwidth_hz;
  EXPECT_EQ(read({}), std::nullopt);
  EXPECT_EQ(read(packet_of(0x52, 4)), std::nullopt);  // a reading
  auto damaged = packet_of(0x5F, 4);
  damaged[2] = 5;
  EXPECT_EQ(read(damaged), std::nullopt);
}

TEST(GyroScanner, ReadsTheProtocolThatTheProfileNames) {
  GyroProfile profile;
  std::vector<GyroMessage> messages;
  sensors::GyroScanner witmotion = sensors::gyro_scanner(profile);
  witmotion.push(numbered_packets(1, 3), messages);
  EXPECT_EQ(messages.size(), 3U);
  EXPECT_EQ(witmotion.counters().messages, 3U);

  profile.protocol = "text";
  sensors::GyroScanner text = sensors::gyro_scanner(profile);
  const std::string lines = "start\n1,2,3\n4,5,6\n";
  text.push({reinterpret_cast<const std::uint8_t*>(lines.data()), lines.size()}, messages);
  EXPECT_EQ(messages.size(), 5U);
  EXPECT_EQ(text.counters().messages, 2U);
}

TEST(GyroScanner, ReadsWhatTheProfileNames) {
  const auto scan = scan_any_chunking<GyroMessage>(
      sensors::gyro_scanner(GyroProfile{.protocol = "witmotion"}), numbered_packets(1, 5), Stream::ends);
  EXPECT_EQ(numbers_of(scan), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(scan.counters, scan_witmotion(numbered_packets(1, 5), Stream::ends).counters);
  const std::string lines = "1,2,3\n4,5,6\n7,8,9\n";
  const GyroProfile text{.protocol = "text"};
  const auto read =
      scan_any_chunking<GyroMessage>(sensors::gyro_scanner(text, sensors::StreamStart::at_line_start),
                                     ByteVector(lines.begin(), lines.end()), Stream::ends);
  EXPECT_EQ(read.messages.size(), 3U);
  EXPECT_EQ(read.counters.bytes_in_messages, lines.size());
}

}  // namespace
}  // namespace thermorig::test

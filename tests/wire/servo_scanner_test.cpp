// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "scan.h"
#include "support/telemetry_bytes.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::test {
namespace {

using wire::ServoMessage;

Scan<ServoMessage> scan_servo(ByteSpan bytes) {
  return scan_any_chunking<ServoMessage>(wire::ServoScanner(), bytes);
}

ByteVector servo_bytes(std::uint8_t type, std::uint8_t sequence, const ByteVector& payload) {
  ByteVector bytes(SERVO_FRAME_MAX);
  bytes.resize(
      servo_frame(bytes.data(), type, sequence, payload.data(), static_cast<std::uint8_t>(payload.size())));
  return bytes;
}

/// Telemetry whose time names it.
ByteVector numbered_telemetry(unsigned index) {
  ServoState state;
  state.mcu_us = 10000 * index;
  state.angle_deg = -12.34;
  state.rate_dps = 200.0;
  state.pulse_us = 0x217E / 16.0F;  // a stop byte and a flag: both have to be escaped
  state.motion = ServoMotion::steady;
  state.leg = 7;
  return test::telemetry_bytes(static_cast<std::uint8_t>(index), state);
}

ByteVector event_bytes(std::uint8_t sequence, std::uint8_t kind) {
  return servo_bytes(SERVO_EVENT, sequence, {kind, 1, 0, 0, 0, 0, 0});
}

const ServoState& state_of(const ServoMessage& message) {
  return std::get<ServoState>(message.body);
}

TEST(ServoScanner, ReadsBackTelemetry) {
  const auto scan = scan_servo(numbered_telemetry(5));
  ASSERT_EQ(scan.messages.size(), 1U);
  const ServoState& state = state_of(scan.messages[0]);
  EXPECT_EQ(state.mcu_us, 50000U);
  EXPECT_DOUBLE_EQ(state.angle_deg, -12.34);
  EXPECT_DOUBLE_EQ(state.rate_dps, 200.0);
  EXPECT_EQ(state.pulse_us, 0x217E / 16.0F);
  EXPECT_EQ(state.motion, ServoMotion::steady);
  EXPECT_EQ(state.leg, 7);
  EXPECT_EQ(scan.messages[0].sequence, 5);
}

TEST(ServoScanner, SpansAFrameWithItsFlags) {
  const ByteVector first = numbered_telemetry(1);
  ByteVector bytes{0x00, 0x00};
  append(bytes, first);
  append(bytes, numbered_telemetry(2));
  const auto scan = scan_servo(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.messages[0].span, (StreamSpan{2, 2 + first.size()}));
  EXPECT_EQ(scan.messages[1].span.begin, 2 + first.size());
  EXPECT_EQ(scan.counters.bytes_skipped, 2U);
  EXPECT_EQ(scan.counters.resyncs, 1U);
}

TEST(ServoScanner, TakesFramesThatShareAFlagAndIdleFlags) {
  ByteVector bytes = numbered_telemetry(1);
  const ByteVector second = numbered_telemetry(2);
  append(bytes, ByteSpan(second).subspan(1));  // its opening flag is the closing one before
  append(bytes, ByteVector(5, SERVO_LINK_FLAG));
  append(bytes, numbered_telemetry(3));
  const auto scan = scan_servo(bytes);
  EXPECT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.counters.bytes_skipped, 5U);
  EXPECT_EQ(scan.counters.resyncs, 0U);
  EXPECT_EQ(scan.counters.bytes_in_messages, bytes.size() - 5);
}

TEST(ServoScanner, CountsLostTelemetryAcrossTheWrap) {
  ByteVector bytes;
  for (const unsigned index : {253U, 254U, 257U, 258U}) append(bytes, numbered_telemetry(index));
  const auto scan = scan_servo(bytes);
  ASSERT_EQ(scan.messages.size(), 4U);
  EXPECT_FALSE(scan.messages[1].lost_before);
  EXPECT_TRUE(scan.messages[2].lost_before);
  EXPECT_FALSE(scan.messages[3].lost_before);
  EXPECT_EQ(scan.counters.lost, 2U);
}

TEST(ServoScanner, DoesNotCallARepeatedFrameALoss) {
  ByteVector bytes;
  for (const unsigned index : {8U, 9U, 9U, 10U}) append(bytes, numbered_telemetry(index));
  const auto scan = scan_servo(bytes);
  EXPECT_EQ(scan.messages.size(), 4U);
  EXPECT_EQ(scan.counters.lost, 0U);
}

TEST(ServoScanner, CountsLostEventsApartFromTelemetry) {
  ByteVector bytes = numbered_telemetry(100);
  append(bytes, event_bytes(0, SERVO_EVENT_LEG_START));
  append(bytes, event_bytes(2, SERVO_EVENT_LEG_END));
  append(bytes, numbered_telemetry(101));
  const auto scan = scan_servo(bytes);
  ASSERT_EQ(scan.messages.size(), 4U);
  EXPECT_FALSE(scan.messages[1].lost_before);
  EXPECT_TRUE(scan.messages[2].lost_before);
  EXPECT_FALSE(scan.messages[3].lost_before);
  EXPECT_EQ(scan.counters.lost, 1U);
  EXPECT_EQ(scan.counters.messages, 2U);
  EXPECT_EQ(scan.counters.replies, 2U);
}

TEST(ServoScanner, ExpectsSequencesToStartAgainAfterAReset) {
  ByteVector bytes = numbered_telemetry(100);
  append(bytes, event_bytes(9, SERVO_EVENT_LEG_START));
  append(bytes, event_bytes(0, SERVO_EVENT_RESET));
  append(bytes, numbered_telemetry(0));
  EXPECT_EQ(scan_servo(bytes).counters.lost, 0U);
}

TEST(ServoScanner, LosesOnlyTheFrameWithAFlippedBit) {
  const std::size_t size = numbered_telemetry(2).size();
  for (std::size_t bit = 8; bit < 8 * (size - 1); ++bit) {  // between the flags
    ByteVector bytes = numbered_telemetry(1);
    ByteVector damaged = numbered_telemetry(2);
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    append(bytes, damaged);
    append(bytes, numbered_telemetry(3));
    const auto scan = scan_servo(bytes);
    ASSERT_EQ(scan.messages.size(), 2U) << "bit " << bit;
    EXPECT_EQ(state_of(scan.messages[1]).mcu_us, 30000U);
    EXPECT_TRUE(scan.messages[1].lost_before);
    EXPECT_EQ(scan.counters.lost, 1U);
    EXPECT_GT(scan.counters.bad_checksum, 0U);
  }
}

TEST(ServoScanner, SurvivesAFlagThatIsFlipped) {
  const ByteVector frame = numbered_telemetry(1);
  for (const std::size_t at : {frame.size() - 1, frame.size()}) {
    ByteVector bytes = frame;
    append(bytes, numbered_telemetry(2));
    append(bytes, numbered_telemetry(3));
    bytes[at] ^= 0x01U;
    const auto scan = scan_servo(bytes);
    ASSERT_FALSE(scan.messages.empty());
    EXPECT_EQ(state_of(scan.messages.back()).mcu_us, 30000U);
    EXPECT_EQ(scan.counters.bad_checksum + scan.counters.bad_length, 1U);
  }
}

TEST(ServoScanner, MarksAnAnswerBehindDamage) {
  ByteVector bytes{SERVO_LINK_FLAG, 1, 2, 3, 4, 5, SERVO_LINK_FLAG};
  append(bytes, servo_bytes(SERVO_ACK, 4, {SERVO_RUN, 1, 0, 0, 0}));
  append(bytes, servo_bytes(SERVO_ACK, 5, {SERVO_RUN, 2, 0, 0, 0}));
  const auto scan = scan_servo(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_TRUE(scan.messages[0].lost_before);
  EXPECT_FALSE(scan.messages[1].lost_before);
  EXPECT_EQ(scan.counters.bytes_in_damaged, 6U);
}

TEST(ServoScanner, CountsUnknownTypesWrongLengthsAndUnknownValues) {
  ByteVector bytes = servo_bytes(0xF0, 1, {1, 2, 3});
  append(bytes, wire::halt_bytes(3));  // a command: it came back through a loop-back plug
  append(bytes, servo_bytes(SERVO_ACK, 1, {SERVO_RUN}));
  ByteVector telemetry(SERVO_TELEMETRY_SIZE);
  telemetry[14] = 99;  // no such motion
  append(bytes, servo_bytes(SERVO_TELEMETRY, 1, telemetry));
  const auto scan = scan_servo(bytes);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_EQ(scan.counters.bad_value, 3U);
  EXPECT_EQ(scan.counters.bad_length, 1U);
  EXPECT_EQ(scan.counters.bytes_in_damaged, bytes.size());
}

TEST(ServoScanner, ReadsTheVersionOfAWelcomeFromAnotherVersion) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{5}, std::size_t{SERVO_WELCOME_SIZE}}) {
    ByteVector payload(size, 0xAA);
    payload[0] = SERVO_LINK_VERSION + 1;
    const auto scan = scan_servo(servo_bytes(SERVO_WELCOME, 0, payload));
    ASSERT_EQ(scan.messages.size(), 1U);
    const auto& welcome = std::get<wire::ServoWelcome>(scan.messages[0].body);
    EXPECT_EQ(welcome.version, SERVO_LINK_VERSION + 1);
    EXPECT_EQ(welcome.firmware, "");
  }
}

TEST(ServoScanner, BooksAnEndlessFrameWhileItLasts) {
  ByteVector bytes{SERVO_LINK_FLAG};
  append(bytes, ByteVector(5000, 'a'));
  const auto endless = scan_servo(bytes);
  EXPECT_EQ(endless.counters.bytes_pending, 0U);
  EXPECT_EQ(endless.counters.bytes_in_damaged, bytes.size());
  EXPECT_EQ(endless.counters.bad_length, 1U);

  append(bytes, numbered_telemetry(1));
  const auto scan = scan_servo(bytes);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_checksum, 0U);
}

TEST(ServoScanner, LeavesAFrameWithoutItsFlagPendingAtTheEnd) {
  ByteVector bytes = numbered_telemetry(1);
  bytes.pop_back();
  const auto scan = scan_any_chunking<ServoMessage>(wire::ServoScanner(), bytes, Stream::ends);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_EQ(scan.counters.bytes_pending, bytes.size());
}

TEST(ServoScanner, DropsTheFrameAroundAStopByte) {
  ByteVector bytes = numbered_telemetry(1);
  bytes.insert(bytes.begin() + 10, SERVO_LINK_STOP);
  append(bytes, numbered_telemetry(2));
  const auto scan = scan_servo(bytes);
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(state_of(scan.messages[0]).mcu_us, 20000U);
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
  EXPECT_EQ(scan.counters.bytes_in_damaged, 10U);
}

TEST(ServoScanner, FindsNothingInNoise) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto scan = scan_servo(random_bytes(5000, seed));
    EXPECT_TRUE(scan.messages.empty());
    EXPECT_LE(scan.counters.bytes_pending, SERVO_FRAME_MAX);
  }
}

TEST(ServoScanner, RestartedForgetsTheSequenceAndTheHalfOfAFrameThatHadCome) {
  wire::ServoScanner scanner;
  std::vector<ServoMessage> messages;
  const ByteVector before = numbered_telemetry(1), after = numbered_telemetry(40);
  scanner.push(before, messages);
  scanner.push(std::span(before).first(before.size() / 2), messages);
  scanner.restart();
  scanner.push(after, messages);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_FALSE(messages[1].lost_before) << "the numbers of another stream tell nothing";
  EXPECT_EQ(scanner.counters().lost, 0U);
  EXPECT_EQ(messages[1].span.end, before.size() + before.size() / 2 + after.size());
  EXPECT_EQ(scanner.counters().bytes_received, messages[1].span.end);
}

}  // namespace
}  // namespace thermorig::test

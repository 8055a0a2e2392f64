// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/camera_scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera_stream.h"
#include "support/camera_commands.h"
#include "support/captures.h"

namespace thermorig::test {
namespace {

constexpr std::size_t frame_size = wire::camera_frame_bytes;
constexpr std::uint8_t sync = gy_mcu90640::sync;

TEST(CameraScanner, FindsEveryFrameOfARealRecordingInAnyChunking) {
  const auto bytes = read_capture("gy_mcu90640_serial/roasted-duck.bin");
  if (!bytes) GTEST_SKIP() << "no captures in " << captures_folder();
  const auto scan = scan_camera(*bytes);
  EXPECT_EQ(scan.messages.size(), 128U);
  EXPECT_EQ(scan.counters.messages, 128U);
  EXPECT_EQ(scan.counters.bytes_in_messages, 128U * frame_size);
  EXPECT_EQ(scan.counters.bad_checksum + scan.counters.bad_length + scan.counters.resyncs, 0U);
  for (const auto& message : scan.messages) {
    EXPECT_THAT(message.frame.temp_c, testing::Each(testing::AllOf(testing::Gt(-40), testing::Lt(300))));
    EXPECT_NEAR(message.frame.sensor_temp_c, 29.0F, 2.0F);  // still warming up
  }
}

TEST(CameraScanner, EncodesARealFrameBackToItsBytes) {
  const auto bytes = read_capture("gy_mcu90640_serial/roasted-duck.bin");
  if (!bytes) GTEST_SKIP() << "no captures in " << captures_folder();
  ByteVector encoded;
  for (const auto& message : scan_camera(*bytes).messages) append(encoded, wire::camera_frame(message.frame));
  EXPECT_EQ(encoded, *bytes);
}

TEST(CameraScanner, ReadsNegativeTemperatures) {
  const auto scan = scan_camera(camera_stream({uniform_frame(-9.61F), uniform_frame(-327.68F)}));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_FLOAT_EQ(scan.messages[0].frame.temp_c[0], -9.61F);
  EXPECT_FLOAT_EQ(scan.messages[0].frame.sensor_temp_c, -9.61F);
  EXPECT_FLOAT_EQ(scan.messages[1].frame.temp_c[767], -327.68F);
}

TEST(CameraScanner, TellsWhereEachFrameStands) {
  ByteVector bytes{1, 2, 3};
  append(bytes, camera_stream({frame_of_noise(1), frame_of_noise(2)}));
  const auto scan = scan_camera(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.messages[0].span, (StreamSpan{3, 3 + frame_size}));
  EXPECT_EQ(scan.messages[1].span, (StreamSpan{3 + frame_size, 3 + 2 * frame_size}));
  EXPECT_TRUE(scan.messages[0].resync_before);
  EXPECT_FALSE(scan.messages[1].resync_before);
  EXPECT_EQ(scan.counters.bytes_skipped, 3U);
  EXPECT_EQ(scan.counters.resyncs, 1U);
}

TEST(CameraScanner, KeepsAnUnfinishedFramePending) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  bytes.pop_back();
  const auto scan = scan_camera(bytes);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_EQ(scan.counters.bytes_pending, frame_size - 1);
}

TEST(CameraScanner, IsNotFooledByPixelsThatLookLikeAHeader) {
  // 231.30 degC is 5A5A, 15.38 degC is 0602: a header at every second pixel.
  ThermalFrame frame;
  for (std::size_t i = 0; i < frame_pixels; ++i) frame.temp_c[i] = i % 2 == 0 ? 231.30F : 15.38F;
  frame.sensor_temp_c = 231.30F;
  const auto scan = scan_camera(camera_stream({frame, uniform_frame(231.30F), frame}));
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_TRUE(same_frame(scan.messages[2].frame, frame));
  EXPECT_EQ(scan.counters.bad_checksum + scan.counters.bad_length + scan.counters.replies, 0U);
}

TEST(CameraScanner, FindsTheNextFrameAfterOneOfHeaderLikePixelsIsCutShort) {
  ByteVector bytes = camera_stream({uniform_frame(231.30F)});
  bytes.resize(777);  // an odd number: the sync bytes that are left straddle two pixels
  append(bytes, camera_stream({frame_of_noise(1), frame_of_noise(2), frame_of_noise(3)}));
  const auto scan = scan_camera(bytes);
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_TRUE(same_frame(scan.messages[0].frame, frame_of_noise(1)));
  EXPECT_TRUE(scan.messages[0].resync_before);
  EXPECT_EQ(scan.counters.bytes_in_damaged, 777U);
  EXPECT_EQ(scan.counters.bytes_skipped, 0U);
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
}

TEST(CameraScanner, TellsWhichHalvesAreFreshByTheWordsOnTheWire) {
  ThermalFrame half = frame_of_noise(1);
  for (std::size_t i = 0; i < frame_pixels; ++i)
    if (subpage_of(i / frame_columns, i % frame_columns) == 1) half.temp_c[i] += 0.01F;
  const auto scan = scan_camera(camera_stream({frame_of_noise(1), half, half}));
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.messages[0].fresh.even, 384);
  EXPECT_EQ(scan.messages[0].fresh.odd, 384);
  EXPECT_EQ(scan.messages[1].fresh.even, 0);
  EXPECT_EQ(scan.messages[1].fresh.odd, 384);
  EXPECT_EQ(scan.messages[2].fresh.even, 0);
  EXPECT_EQ(scan.messages[2].fresh.odd, 0);
}

TEST(CameraScanner, CountsRepliesBetweenFrames) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  append(bytes, camera_emissivity_reply(95));
  append(bytes, camera_stream({frame_of_noise(2)}));
  append(bytes, camera_emissivity_reply(90));  // its emissivity is the sync byte
  append(bytes, camera_stream({frame_of_noise(3)}));
  const auto scan = scan_camera(bytes);
  EXPECT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.counters.replies, 2U);
  EXPECT_EQ(scan.counters.bytes_in_messages, bytes.size());
  EXPECT_FALSE(scan.messages[1].resync_before);
  EXPECT_FALSE(scan.messages[2].resync_before);
}

TEST(CameraScanner, RejectsTheFramesOfASinglePixelSensor) {
  // GY-MCU90614: sync, sync, 45 04, two temperatures, sum: the same sync bytes, another length.
  ByteVector bytes;
  for (int i = 0; i < 20; ++i)
    append(bytes, ByteVector{sync, sync, 0x45, 0x04, 0x0C, 0x80, 0x0B, 0xB8, 0x4C});
  const auto scan = scan_camera(bytes);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_EQ(scan.counters.bad_length, 20U);
  EXPECT_EQ(scan.counters.replies, 0U);
  EXPECT_EQ(scan.counters.bytes_skipped, bytes.size());
}

TEST(CameraScanner, CountsAWrongLengthAndFindsTheNextFrame) {
  ByteVector bytes = camera_stream({frame_of_noise(1, 2000, 3000)});
  bytes[2] = 0x00;
  append(bytes, camera_stream({frame_of_noise(2)}));
  const auto scan = scan_camera(bytes);
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_TRUE(same_frame(scan.messages[0].frame, frame_of_noise(2)));
  EXPECT_EQ(scan.counters.bad_length, 1U);
  EXPECT_EQ(scan.counters.bytes_skipped, frame_size);
}

TEST(CameraScanner, SeesNeitherRepliesNorLengthsInTheMiddleOfADamagedFrame) {
  ThermalFrame frame = uniform_frame(20.0F);
  frame.temp_c[100] = frame.temp_c[200] = 231.30F;  // 5A5A
  frame.temp_c[101] = 49.59F;                       // with it: 5A 5A 5F 13, a reply
  ByteVector bytes = camera_stream({frame, frame});
  bytes[10] ^= 0x01U;
  const auto scan = scan_camera(bytes);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
  EXPECT_EQ(scan.counters.bad_length, 0U);
  EXPECT_EQ(scan.counters.replies, 0U);
  EXPECT_EQ(scan.counters.bytes_in_damaged, frame_size);
}

TEST(CameraScanner, DoesNotTakeAHeadersFirstByteForTheSumOfAReply) {
  ByteVector bytes{sync, sync, static_cast<std::uint8_t>(sync - 2 * sync)};  // the next byte would be the sum
  append(bytes, camera_stream({frame_of_noise(1)}));
  const auto scan = scan_camera(bytes);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.replies, 0U);
}

TEST(CameraScanner, SkipsSyncBytesBeforeAHeader) {
  ByteVector bytes{sync};
  append(bytes, camera_stream({frame_of_noise(1)}));
  append(bytes, ByteVector{sync, sync});
  append(bytes, camera_stream({frame_of_noise(2)}));
  const auto scan = scan_camera(bytes);
  EXPECT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.counters.bytes_skipped, 3U);
  EXPECT_EQ(scan.counters.bad_length, 0U);
}

TEST(CameraScanner, RejectsAFrameWithAnyBitFlipped) {
  const ByteVector good = camera_stream({frame_of_noise(1)});
  for (std::size_t bit = 0; bit < 8 * frame_size; bit += 7) {
    ByteVector bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    wire::CameraScanner scanner;
    std::vector<wire::CameraMessage> messages;
    scanner.push(bytes, messages);
    EXPECT_TRUE(messages.empty()) << "bit " << bit;
  }
}

TEST(CameraScanner, KeepsNoMoreThanOneFrameOfNoise) {
  // Headers all over: each is a candidate that has to wait for its 1544 bytes.
  ByteVector bytes;
  const ByteVector frame = camera_stream({frame_of_noise(1)});
  for (int i = 0; i < 5000; ++i) append(bytes, ByteSpan(frame).first(gy_mcu90640::header_bytes));
  const auto scan = scan_camera(bytes);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_LT(scan.counters.bytes_pending, frame_size + gy_mcu90640::reply_bytes);
  EXPECT_GT(scan.counters.bad_checksum, 1000U);
}

TEST(CameraScanner, AcceptsAByteSumOnlyWhereTheProfileSaysSo) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  unsigned sum = 0;
  for (std::size_t i = 0; i < frame_size - 2; ++i) sum += bytes[i];
  bytes[frame_size - 2] = static_cast<std::uint8_t>(sum & 0xFFU);
  bytes[frame_size - 1] = static_cast<std::uint8_t>((sum >> 8U) & 0xFFU);
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::byte).messages.size(), 1U);
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::word).messages.size(), 0U);
}

TEST(CameraScanner, WithoutAChecksumNeedsTheNextHeaderInItsPlace) {
  ByteVector bytes = camera_stream({frame_of_noise(1), frame_of_noise(2), frame_of_noise(3)});
  for (std::size_t i = 1; i <= 3; ++i) bytes[i * frame_size - 1] ^= 0xFFU;
  const auto scan = scan_camera(bytes, ChecksumPolicy::ignore);
  EXPECT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.counters.bytes_pending, frame_size);

  bytes.erase(bytes.begin() + 100);  // the first frame is a byte short
  const auto shifted = scan_camera(bytes, ChecksumPolicy::ignore);
  ASSERT_EQ(shifted.messages.size(), 1U);
  EXPECT_TRUE(same_frame(shifted.messages[0].frame, frame_of_noise(2)));
  EXPECT_EQ(shifted.counters.bad_checksum, 1U);
}

TEST(CameraScanner, WithoutAChecksumAReplyBehindAFrameVouchesForItToo) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  append(bytes, camera_emissivity_reply(95));
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::ignore).messages.size(), 1U);
}

TEST(CameraScanner, WithoutAChecksumTheEndOfTheStreamVouchesForTheLastFrame) {
  ByteVector bytes = camera_stream({frame_of_noise(1), frame_of_noise(2)});
  bytes.back() ^= 0xFFU;
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::ignore, Stream::ends).messages.size(), 2U);
  bytes.push_back(sync);  // cut inside the next header
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::ignore, Stream::ends).messages.size(), 2U);
  bytes.back() = 0;
  const auto scan = scan_camera(bytes, ChecksumPolicy::ignore, Stream::ends);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
}

TEST(CameraScanner, FindsEveryFrameOfARealRecordingWithoutItsChecksums) {
  const auto bytes = read_capture("gy_mcu90640_serial/roasted-duck.bin");
  if (!bytes) GTEST_SKIP() << "no captures in " << captures_folder();
  EXPECT_EQ(scan_camera(*bytes, ChecksumPolicy::ignore, Stream::ends).messages.size(), 128U);
}

/// Three frames; a reply stands inside the second one, `offset` bytes from its start.
ByteVector stream_with_interrupted_frame(std::size_t offset) {
  ByteVector bytes = camera_stream({frame_of_noise(1), frame_of_noise(2), frame_of_noise(3)});
  const auto reply = camera_emissivity_reply(95);
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(frame_size + offset), reply.begin(), reply.end());
  return bytes;
}

TEST(CameraScanner, RecoversAFrameThatAReplyInterrupts) {
  for (const std::size_t offset : {4UL, 5UL, 770UL, 771UL, frame_size - 3, frame_size - 2, frame_size - 1}) {
    SCOPED_TRACE(offset);
    const ByteVector bytes = stream_with_interrupted_frame(offset);
    const auto scan = scan_camera(bytes);
    ASSERT_EQ(scan.messages.size(), 3U);
    EXPECT_TRUE(same_frame(scan.messages[1].frame, frame_of_noise(2)));
    EXPECT_EQ(scan.messages[1].span, (StreamSpan{frame_size, 2 * frame_size + gy_mcu90640::reply_bytes}));
    EXPECT_FALSE(scan.messages[2].resync_before);
    EXPECT_EQ(scan.counters.replies, 1U);
    EXPECT_EQ(scan.counters.bad_checksum, 0U);
    EXPECT_EQ(scan.counters.bytes_in_messages, bytes.size());
  }
}

TEST(CameraScanner, TakesNothingOutOfAnInterruptedFrameThatIsDamagedAsWell) {
  ByteVector bytes = stream_with_interrupted_frame(700);
  bytes[frame_size + 300] ^= 0x04U;
  const auto scan = scan_camera(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_TRUE(same_frame(scan.messages[1].frame, frame_of_noise(3)));
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
  EXPECT_EQ(scan.counters.replies, 0U);
}

TEST(CameraScanner, RecoversAnInterruptedFrameOfAByteSum) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  unsigned sum = 0;
  for (std::size_t i = 0; i < frame_size - 2; ++i) sum += bytes[i];
  bytes[frame_size - 2] = static_cast<std::uint8_t>(sum & 0xFFU);
  bytes[frame_size - 1] = static_cast<std::uint8_t>((sum >> 8U) & 0xFFU);
  const auto reply = camera_emissivity_reply(95);
  bytes.insert(bytes.begin() + 1001, reply.begin(), reply.end());
  EXPECT_EQ(scan_camera(bytes, ChecksumPolicy::byte).messages.size(), 1U);
}

TEST(CameraScanner, DecidesADamagedLastFrameAtTheEndOfTheStream) {
  ByteVector bytes = camera_stream({frame_of_noise(1)});
  bytes[100] ^= 0x10U;
  EXPECT_EQ(scan_camera(bytes).counters.bytes_pending, frame_size);
  const auto scan = scan_camera(bytes, ChecksumPolicy::word, Stream::ends);
  EXPECT_EQ(scan.counters.bad_checksum, 1U);
  EXPECT_EQ(scan.counters.bytes_in_damaged, frame_size);
}

TEST(CameraScanner, RestartedHoldsTheNextFrameAgainstNoneAndForgetsTheHalfThatHadCome) {
  wire::CameraScanner scanner(ChecksumPolicy::word);
  std::vector<wire::CameraMessage> messages;
  const ByteVector frame = camera_stream({uniform_frame(20.0F)});
  scanner.push(frame, messages);
  scanner.push(std::span(frame).first(frame_size / 2), messages);
  scanner.restart();
  scanner.push(frame, messages);
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[1].fresh.even + messages[1].fresh.odd, 768) << "no frame of this stream was before it";
  EXPECT_FALSE(messages[1].resync_before);
  EXPECT_EQ(messages[1].span.end, 2 * frame_size + frame_size / 2);
  EXPECT_EQ(scanner.counters().bytes_skipped + scanner.counters().bytes_in_damaged, 0U);
}

}  // namespace
}  // namespace thermorig::test

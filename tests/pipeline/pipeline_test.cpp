// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scripted_bytes.h"
#include "servo_link.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::pipeline {
namespace {

constexpr std::size_t whole_stream = 1 << 20;

bool has(const LabelledSample& sample, Reason reason) {
  return (sample.reason_bits & bit(reason)) != 0;
}

double distance_s(HostTime a, HostTime b) {
  return std::abs(to_s(a - b));
}

/// On links on which the fastest byte never waits, not even for a USB frame.
ScriptedRecording prompt_recording() {
  ScriptedRecording recording;
  for (const Device device : all_devices) recording.profile.link(device).largest_constant_delay_s = 0.0;
  return recording;
}

bool are_alike(float a, float b) {
  return std::isnan(a) ? std::isnan(b) : std::abs(a - b) < 1e-3F;
}

TEST(Pipeline, LabelsASweepFromItsBytes) {
  const ScriptedRecording recording;
  const auto chunks = chunks_within_messages(recording, whole_stream);
  const Result result = run(recording.profile, chunks, first_pass(recording.profile, chunks));
  ASSERT_EQ(result.samples.size(), 39U);
  int valid = 0;
  for (const LabelledSample& sample : result.samples) {
    if (!sample.valid) continue;
    ++valid;
    EXPECT_NEAR(sample.rate_commanded_dps, 100.0, 0.05);
    EXPECT_NEAR(sample.rate_shaft_dps, 100.0, 0.3);  // pulses are put out in steps
    EXPECT_NEAR(sample.rate_gyro_dps, 100.0, wire::witmotion_dps_per_count);
    EXPECT_EQ(sample.gyro_count, 50);
    EXPECT_EQ(sample.leg, 7);
    EXPECT_EQ(sample.run, 1U);
  }
  // Steady from 1.052 to 3.95; the servo settles within 0.2; 0.25 of exposure: at least those that end at
  // 1.625, 1.75, ... 3.875.
  EXPECT_GE(valid, 19);
  EXPECT_LE(valid, 21);
}

TEST(Pipeline, StampsMessagesWithTheBeginOfTheirFirstByte) {
  const ScriptedRecording recording = prompt_recording();
  const Result result = run(recording.profile, chunks_within_messages(recording, 100));
  ASSERT_EQ(result.streams.frames.size(), 39U);
  for (std::size_t i = 0; i < result.streams.frames.size(); ++i) {
    const TimedFrame& frame = result.streams.frames[i];
    EXPECT_LT(distance_s(frame.stamp.time, HostTime(from_s(0.125 * static_cast<double>(i + 1)))), 2e-9);
    EXPECT_EQ(frame.exposure_end, frame.stamp.time);
    EXPECT_EQ(frame.exposure_begin, frame.stamp.time - from_s(0.25));
    EXPECT_EQ(frame.span, (StreamSpan{i * 1544, (i + 1) * 1544}));
  }
}

TEST(Pipeline, TakesTheLatencyOffTheStamp) {
  ScriptedRecording recording;
  recording.profile.camera.link.latency_s = 0.02;
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  EXPECT_LT(distance_s(result.streams.frames[0].stamp.time, HostTime(from_s(0.125 - 0.02))), 2e-9);
}

TEST(Pipeline, GivesTheSameSamplesWhateverTheChunksWithinMessages) {
  const ScriptedRecording recording = prompt_recording();
  const Result once = run(recording.profile, chunks_within_messages(recording, whole_stream));
  for (const std::size_t chunk_bytes : {1U, 7U, 64U, 1000U}) {
    const Result again = run(recording.profile, chunks_within_messages(recording, chunk_bytes));
    ASSERT_EQ(again.samples.size(), once.samples.size());
    for (std::size_t i = 0; i < once.samples.size(); ++i) {
      const LabelledSample &a = once.samples[i], &b = again.samples[i];
      EXPECT_LT(distance_s(a.time, b.time), 5e-9);
      EXPECT_TRUE(are_alike(a.rate_shaft_dps, b.rate_shaft_dps)) << i;
      // A sample at either end of the exposure may lie in it or not, by microseconds.
      EXPECT_NEAR(a.gyro_count, b.gyro_count, 1);
      EXPECT_NEAR(a.rate_gyro_dps, b.rate_gyro_dps, 100.0 / 49) << i;
      // How sure a time is depends on how the bytes were read.
      EXPECT_EQ(a.reason_bits & ~bit(Reason::sync_lost), b.reason_bits & ~bit(Reason::sync_lost)) << i;
    }
  }
}

TEST(Pipeline, GivesTheSameMessagesWhateverTheChunks) {
  const ScriptedRecording recording;
  const Result once = run(recording.profile, chunks_within_messages(recording, whole_stream));
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Result again = run(recording.profile, chunks_across_messages(recording, seed, 1U << (seed + 2)));
    ASSERT_EQ(again.streams.frames.size(), once.streams.frames.size());
    ASSERT_EQ(again.streams.gyro.size(), once.streams.gyro.size());
    ASSERT_EQ(again.streams.servo.size(), once.streams.servo.size());
    EXPECT_EQ(again.samples.size(), once.samples.size());
    for (std::size_t i = 0; i < once.streams.frames.size(); ++i) {
      EXPECT_EQ(again.streams.frames[i].frame.temp_c, once.streams.frames[i].frame.temp_c);
      EXPECT_EQ(again.streams.frames[i].span, once.streams.frames[i].span);
    }
    for (const Device device : all_devices)
      EXPECT_EQ(again.counters[device], once.counters[device]) << name_of(device);
  }
}

TEST(Pipeline, AppliesAxisAndSignOfTheGyro) {
  ScriptedRecording recording;
  Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  const TimedGyro& turning = result.streams.gyro.at(500);
  EXPECT_NEAR(turning.rate_dps, 100.0, wire::witmotion_dps_per_count);
  EXPECT_NEAR(turning.reading.rate_dps[1], -100.0, wire::witmotion_dps_per_count);
  recording.profile.gyro.axis = 2;
  recording.profile.gyro.sign = 1;
  result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  EXPECT_NEAR(result.streams.gyro.at(500).rate_dps, -5 * wire::witmotion_dps_per_count, 1e-4);
}

TEST(Pipeline, UnwrapsTheServosTime) {
  const ScriptedRecording recording;
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  for (std::size_t i = 0; i < result.streams.servo.size(); ++i)
    EXPECT_EQ(result.streams.servo[i].mcu_time_us, 0xFFF00000LL + 10'000LL * static_cast<std::int64_t>(i));
}

TEST(Pipeline, SortsPongsAndAnswersFromTelemetry) {
  ScriptedRecording recording;
  const auto message = [&](std::uint8_t type, std::vector<std::uint8_t> payload) {
    std::vector<std::uint8_t> bytes(SERVO_FRAME_MAX);
    bytes.resize(
        servo_frame(bytes.data(), type, 9, payload.data(), static_cast<std::uint8_t>(payload.size())));
    return bytes;
  };
  recording.messages.push_back(
      {Device::servo, HostTime(from_s(2.006)), message(SERVO_PONG, {1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0})});
  recording.messages.push_back(
      {Device::servo, HostTime(from_s(2.007)), message(SERVO_ACK, {SERVO_RUN, 4, 0, 0, 0})});
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  EXPECT_EQ(result.streams.servo.size(), 500U);
  ASSERT_EQ(result.streams.pongs.size(), 1U);
  EXPECT_EQ(result.streams.pongs[0].token, 1U);
  EXPECT_EQ(result.streams.pongs[0].receive_us, 2U);
  EXPECT_EQ(result.streams.pongs[0].send_us, 3U);
  EXPECT_LT(distance_s(result.streams.pongs[0].arrival, HostTime(from_s(2.006))), 2e-3);
  ASSERT_EQ(result.streams.servo_answers.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<wire::ServoAck>(result.streams.servo_answers[0].body));
}

TEST(Pipeline, FlagsTheFrameAfterDamagedBytes) {
  ScriptedRecording recording;
  int frame = 0;
  for (ScriptedMessage& message : recording.messages)
    if (message.device == Device::camera && frame++ == 20) message.bytes[800] ^= 0x10;
  const Result result = run(recording.profile, chunks_within_messages(recording, 64));
  ASSERT_EQ(result.samples.size(), 38U);
  EXPECT_TRUE(has(result.samples[20], Reason::checksum));
  EXPECT_TRUE(has(result.samples[20], Reason::camera_gap));
  EXPECT_FALSE(has(result.samples[20], Reason::camera_not_fresh));  // both halves differ from two frames back
  EXPECT_EQ(result.samples[19].run, 1U);
  EXPECT_EQ(result.samples[20].run, 0U);
  EXPECT_EQ(result.samples[21].run, 2U);
  EXPECT_EQ(result.counters[Device::camera].bad_checksum, 1U);
}

TEST(Pipeline, AFramesHalfThatComesTwiceIsNotFresh) {
  ScriptedRecording recording;
  std::vector<ScriptedMessage*> frames;
  for (ScriptedMessage& message : recording.messages)
    if (message.device == Device::camera) frames.push_back(&message);
  frames[20]->bytes = frames[19]->bytes;
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  EXPECT_TRUE(has(result.samples[20], Reason::camera_not_fresh));
  EXPECT_FALSE(has(result.samples[19], Reason::camera_not_fresh));
}

TEST(Pipeline, LabelsWithoutGyroAndServoAfterWaiting) {
  ScriptedRecording recording;
  std::erase_if(recording.messages, [](const ScriptedMessage& m) { return m.device != Device::camera; });
  Pipeline pipeline(recording.profile);
  std::size_t count = 0;
  for (const Chunk& chunk : chunks_within_messages(recording, whole_stream))
    count += pipeline.feed(chunk.device, chunk.bytes, chunk.arrived).size();
  EXPECT_EQ(count, 39U - 8U);  // all but those of the last second
  EXPECT_EQ(pipeline.finish().size(), 8U);
  EXPECT_TRUE(pipeline.finish().empty());
}

TEST(Pipeline, TakesTheLastFrameOfAStreamWithoutChecksums) {
  ScriptedRecording recording;
  recording.profile.camera.checksum = ChecksumPolicy::ignore;
  Pipeline pipeline(recording.profile);
  std::size_t frames = 0, samples = 0;
  for (const Chunk& chunk : chunks_within_messages(recording, whole_stream))
    samples += pipeline.feed(chunk.device, chunk.bytes, chunk.arrived).size();
  frames = pipeline.take_streams().frames.size();
  EXPECT_EQ(frames, 38U);  // the last one waits for what stands behind it
  samples += pipeline.finish().size();
  EXPECT_EQ(pipeline.take_streams().frames.size(), 1U);
  EXPECT_EQ(samples, 39U);
}

TEST(Pipeline, HandsOutItsStreamsOnce) {
  const ScriptedRecording recording;
  Pipeline pipeline(recording.profile);
  std::size_t frames = 0;
  for (const Chunk& chunk : chunks_within_messages(recording, whole_stream)) {
    pipeline.feed(chunk.device, chunk.bytes, chunk.arrived);
    const Streams streams = pipeline.take_streams();
    EXPECT_LE(streams.frames.size() + streams.gyro.size() + streams.servo.size(),
              2U);  // two: the gyro's first
    frames += streams.frames.size();
  }
  EXPECT_EQ(frames, 39U);
}

TEST(Pipeline, DecodesTheSameStreamsWithoutLabels) {
  const ScriptedRecording recording;
  const auto chunks = chunks_within_messages(recording, whole_stream);
  const Streams labelled = run(recording.profile, chunks).streams;
  Pipeline pipeline(recording.profile, {}, true);
  for (const Chunk& chunk : chunks)
    EXPECT_TRUE(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived).empty());
  EXPECT_TRUE(pipeline.finish().empty());
  const Streams streams = pipeline.take_streams();
  const auto expect_same = [](const auto& now, const auto& before) {
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
      EXPECT_EQ(now[i].span, before[i].span);
      EXPECT_EQ(now[i].stamp.time, before[i].stamp.time);
    }
  };
  expect_same(streams.frames, labelled.frames);
  expect_same(streams.gyro, labelled.gyro);
  expect_same(streams.servo, labelled.servo);
}

TEST(Pipeline, FollowsAFullFreshCameraLive) {
  const ScriptedRecording recording(5.0, false);
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream));
  EXPECT_EQ(result.samples[0].exposure_end - result.samples[0].exposure_begin, from_s(0.25));
  for (std::size_t i = 1; i < result.samples.size(); ++i) {
    EXPECT_EQ(result.samples[i].exposure_end - result.samples[i].exposure_begin, from_s(0.125));
    EXPECT_FALSE(has(result.samples[i], Reason::camera_not_fresh));
  }
}

TEST(Pipeline, TakesModeAndPeriodFromTheFits) {
  const ScriptedRecording recording;
  const Fits fits{.camera_mode = labels::CameraMode::full_fresh, .frame_period_s = 0.13};
  const Result result = run(recording.profile, chunks_within_messages(recording, whole_stream), fits);
  for (const LabelledSample& sample : result.samples)
    EXPECT_EQ(sample.exposure_end - sample.exposure_begin, from_s(0.13));
  EXPECT_TRUE(has(result.samples[10], Reason::camera_not_fresh));
}

TEST(Pipeline, ToleratesArrivalsThatRunBackwards) {
  const ScriptedRecording recording;
  auto chunks = chunks_within_messages(recording, 64);
  for (std::size_t i = 0; i < chunks.size(); i += 17) chunks[i].arrived -= from_s(3.0);
  const Result result = run(recording.profile, chunks);
  EXPECT_EQ(result.samples.size(), 39U);
}

}  // namespace
}  // namespace thermorig::pipeline

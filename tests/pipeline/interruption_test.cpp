// SPDX-License-Identifier: MIT
// A device that goes and comes back: two streams of two clocks, and nothing that reaches over the gap.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fit/pieces.h"
#include "scripted_bytes.h"
#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/replay.h"

namespace thermorig::pipeline {
namespace {

using ::testing::HasSubstr;

constexpr double gone_s = 2.0;
constexpr double back_s = 3.3;

/// The scripted sweep without what `device` sent while it was away.
RawRecording with_absence(Device device, std::size_t chunk_bytes = 100) {
  const ScriptedRecording script(8.0);
  RawRecording raw;
  raw.header.profile = script.profile;
  for (const Chunk& chunk : chunks_within_messages(script, chunk_bytes)) {
    const double time_s = to_s(chunk.arrived - HostTime{});
    if (chunk.device == device && time_s > gone_s && time_s < back_s) continue;
    raw.received[chunk.device].append(chunk.bytes, chunk.arrived);
    raw.end_time = std::max(raw.end_time, chunk.arrived);
  }
  raw.events.push_back({HostTime(from_s(gone_s)), EventKind::device_lost, device, "unplugged"});
  return raw;
}

struct Passed {
  Streams streams;
  std::vector<LabelledSample> samples;
  Fits fits;
};

Passed pass(const RawRecording& raw, const Fits& fits) {
  Pipeline pipeline(raw.header.profile, fits);
  Passed passed;
  Replay replay(raw);
  while (const auto step = replay.next())
    for (const Measurement& made : feed(pipeline, *step)) passed.samples.push_back(made.sample);
  for (const Measurement& made : pipeline.finish()) passed.samples.push_back(made.sample);
  passed.streams = pipeline.take_streams();
  return passed;
}

Passed both_passes(const RawRecording& raw) {
  const Fits fits = fit::fit_recording(raw, pass(raw, {}).streams);
  Passed passed = pass(raw, fits);
  passed.fits = fits;
  return passed;
}

bool has_reason(const LabelledSample& sample, Reason reason) {
  return (sample.reason_bits & bit(reason)) != 0;
}

TEST(Interruption, OfTheCameraMarksTheFirstFrameThatComesAgain) {
  for (const bool final_pass : {false, true}) {
    const RawRecording raw = with_absence(Device::camera);
    const Passed passed = final_pass ? both_passes(raw) : pass(raw, {});
    const auto& frames = passed.streams.frames;
    const auto first = std::find_if(frames.begin(), frames.end(), [](const TimedFrame& frame) {
      return frame.stamp.arrival > HostTime(from_s(back_s));
    });
    ASSERT_NE(first, frames.end());
    EXPECT_NEAR(first->missing_before, (back_s - gone_s) * 8.0, 1.5) << final_pass;
    const auto& sample = passed.samples.at(static_cast<std::size_t>(first - frames.begin()));
    EXPECT_TRUE(has_reason(sample, Reason::camera_gap));
    EXPECT_NE(sample.run, passed.samples.at(static_cast<std::size_t>(first - frames.begin()) - 1).run);
    for (auto next = first + 1; next != frames.end(); ++next) EXPECT_EQ(next->missing_before, 0);
  }
}

TEST(Interruption, BeginsANewEpochWithAGapBeforeIt) {
  for (const Device device : all_devices) {
    const Passed passed = both_passes(with_absence(device));
    const ClockReport& clock = passed.fits.sync->clock[device];
    ASSERT_EQ(clock.epochs.size(), 2U) << name_of(device);
    EXPECT_THAT(clock.epochs[1].reason, HasSubstr(std::string(name_of(device)) + " was away for 1."));
    ASSERT_FALSE(clock.gaps.empty());
    EXPECT_NEAR(to_s(clock.gaps[0].end - clock.gaps[0].begin), back_s - gone_s, 0.3);
    for (const Device other : all_devices)
      if (other != device) {
        EXPECT_EQ(passed.fits.sync->clock[other].epochs.size(), 1U);
      }
  }
}

TEST(Interruption, NeverJoinsTheTwoHalvesOfAMessage) {
  // Cut in the middle of a message before it, begun again in the middle of one: halves that fit together.
  for (const Device device : all_devices) {
    RawRecording raw = with_absence(device);
    RawStream& stream = raw.received[device];
    const std::uint64_t at = fit::break_offsets(raw, device).at(0);
    RawStream cut;
    for (std::size_t i = 0; i < stream.chunk_count(); ++i) {
      auto bytes = stream.chunk(i);
      if (stream.chunk_end[i] == at) bytes = bytes.first(bytes.size() / 2);
      cut.append(bytes, stream.time(i));
    }
    stream = cut;
    const std::uint64_t joint = fit::break_offsets(raw, device).at(0);
    const Passed passed = pass(raw, {});
    const auto spans = [&](const auto& messages) {
      return std::any_of(messages.begin(), messages.end(), [&](const auto& message) {
        return message.span.begin < joint && joint < message.span.end;
      });
    };
    EXPECT_FALSE(device == Device::camera && spans(passed.streams.frames));
    EXPECT_FALSE(device == Device::gyro && spans(passed.streams.gyro));
    EXPECT_FALSE(device == Device::servo && spans(passed.streams.servo));
  }
}

TEST(Interruption, OfTheServoLeavesNoFrameOverTheGapValid) {
  const Passed passed = both_passes(with_absence(Device::servo));
  for (const LabelledSample& sample : passed.samples) {
    const double begin_s = to_s(sample.exposure_begin - HostTime{});
    const double end_s = to_s(sample.exposure_end - HostTime{});
    const bool touches = begin_s < back_s - 0.02 && end_s > gone_s + 0.02;
    EXPECT_FALSE(touches && sample.valid) << begin_s;
  }
}

TEST(Interruption, MakesTheMicroControllersTimeJumpAhead) {
  const Passed passed = pass(with_absence(Device::servo), {});
  const auto& servo = passed.streams.servo;
  std::size_t jumps = 0;
  for (std::size_t i = 1; i < servo.size(); ++i) {
    const std::int64_t step_us = servo[i].mcu_time_us - servo[i - 1].mcu_time_us;
    EXPECT_GT(step_us, 0);
    jumps += step_us > (std::int64_t{1} << 32U) ? 1 : 0;
  }
  EXPECT_EQ(jumps, 1U);
}

TEST(Interruption, BeforeTheFirstByteOrAfterTheLastIsNone) {
  RawRecording raw = with_absence(Device::camera);
  raw.events = {{HostTime(from_s(0.0)), EventKind::missing, Device::camera, ""},
                {raw.end_time, EventKind::device_lost, Device::camera, ""},
                {HostTime(from_s(2.5)), EventKind::device_lost, std::nullopt, ""}};
  EXPECT_TRUE(fit::break_offsets(raw, Device::camera).empty());
}

TEST(Interruption, OfAnUnsortedListIsStillTakenInOrder) {
  RawRecording raw = with_absence(Device::camera);
  raw.events.insert(raw.events.begin(), {HostTime(from_s(5.0)), EventKind::device_lost, Device::camera, ""});
  const auto offsets = fit::break_offsets(raw, Device::camera);
  ASSERT_EQ(offsets.size(), 2U);
  EXPECT_LT(offsets[0], offsets[1]);
  EXPECT_EQ(both_passes(raw).fits.sync->clock[Device::camera].epochs.size(), 3U);
}

TEST(Interruption, OfWhichAFileClaimsTooManyAreCountedToALimit) {
  RawRecording raw = with_absence(Device::camera);
  for (int i = 0; i < 5000; ++i)
    raw.events.push_back({HostTime(from_s(0.001 * i)), EventKind::device_lost, Device::gyro, ""});
  EXPECT_EQ(fit::break_offsets(raw, Device::gyro).size(), 255U);
  both_passes(raw);
}

TEST(Interruption, IsTheSameInACausalReplay) {
  const RawRecording raw = with_absence(Device::camera);
  const Passed passed = pass(raw, {});
  CausalReplay replay(raw);
  std::size_t index = 0;
  while (const auto moment = replay.next())
    for (const Measurement& measurement : moment->measurements) {
      EXPECT_EQ(measurement.frame.stamp.time, passed.streams.frames.at(index).stamp.time);
      EXPECT_EQ(measurement.sample.reason_bits, passed.samples.at(index).reason_bits);
      ++index;
    }
  EXPECT_EQ(index, passed.samples.size());
}

}  // namespace
}  // namespace thermorig::pipeline

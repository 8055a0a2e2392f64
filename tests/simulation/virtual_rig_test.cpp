// SPDX-License-Identifier: MIT
#include "thermorig/simulation/virtual_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "scripted_firmware.h"
#include "support/at_s.h"
#include "support/camera_commands.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

std::unique_ptr<ScriptedFirmware> sweep(double rate_dps) {
  return std::make_unique<ScriptedFirmware>(
      [rate_dps](double time_s) { return rate_dps * std::max(0.0, time_s - 1.0); }, default_profile().servo);
}

std::vector<Chunk> run(VirtualRig& rig, double seconds, double step_s) {
  std::vector<Chunk> chunks;
  const int steps = static_cast<int>(std::lround(seconds / step_s));
  for (int step = 1; step <= steps; ++step)
    for (Chunk& chunk : rig.advance(at_s(step * step_s))) chunks.push_back(std::move(chunk));
  return chunks;
}

std::vector<Chunk> run_default(std::uint64_t seed, double seconds, double step_s) {
  VirtualRig rig(default_rig(seed, "garden"), sweep(100.0));
  return run(rig, seconds, step_s);
}

void expect_equal(const std::vector<Chunk>& left, const std::vector<Chunk>& right) {
  ASSERT_EQ(left.size(), right.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    ASSERT_EQ(left[i].device, right[i].device);
    ASSERT_EQ(left[i].arrived, right[i].arrived);
    ASSERT_EQ(left[i].bytes, right[i].bytes);
  }
}

std::vector<std::uint8_t> bytes_of(const std::vector<Chunk>& chunks, Device device) {
  std::vector<std::uint8_t> bytes;
  for (const Chunk& chunk : chunks)
    if (chunk.device == device) bytes.insert(bytes.end(), chunk.bytes.begin(), chunk.bytes.end());
  return bytes;
}

std::vector<wire::CameraMessage> frames_of(const std::vector<Chunk>& chunks) {
  wire::CameraScanner scanner;
  std::vector<wire::CameraMessage> frames;
  scanner.push(bytes_of(chunks, Device::camera), frames);
  return frames;
}

TEST(VirtualRig, RepeatsItselfWithTheSameSeedAndWithNoOther) {
  const auto first = run_default(3, 5.0, 0.01);
  expect_equal(first, run_default(3, 5.0, 0.01));
  const auto other = run_default(4, 5.0, 0.01);
  EXPECT_NE(bytes_of(first, Device::camera), bytes_of(other, Device::camera));
  EXPECT_NE(bytes_of(first, Device::gyro), bytes_of(other, Device::gyro));
}

TEST(VirtualRig, DoesNotDependOnTheStepsInWhichItIsAdvanced) {
  expect_equal(run_default(3, 5.0, 0.001), run_default(3, 5.0, 1.0));
}

TEST(VirtualRig, GivesChunksInOrderOfArrivalAndNoneFromTheFuture) {
  VirtualRig rig(default_rig(1, "dining"), sweep(50.0));
  HostTime before = at_s(0.0);
  for (int step = 1; step <= 400; ++step)
    for (const Chunk& chunk : rig.advance(at_s(0.01 * step))) {
      EXPECT_GE(chunk.arrived, before);
      EXPECT_LE(chunk.arrived, at_s(0.01 * step));
      before = chunk.arrived;
    }
  EXPECT_GT(before, at_s(3.9));
}

TEST(VirtualRig, SendsEveryFrameAndSampleThatItRemembersInOrder) {
  VirtualRig rig(default_rig(2, "kitchen"), sweep(100.0));
  rig.keep_truth(true);
  const auto chunks = run(rig, 10.0, 0.02);
  const auto frames = frames_of(chunks);
  sensors::GyroScanner scanner = sensors::gyro_scanner(default_profile().gyro);
  std::vector<wire::GyroMessage> gyro;
  scanner.push(bytes_of(chunks, Device::gyro), gyro);
  EXPECT_NEAR(static_cast<double>(frames.size()), 10.0 * 8.0 * 0.98, 2.0);
  EXPECT_LE(rig.sent_frames().size() - frames.size(), 1U);  // one may be on its way
  EXPECT_LE(rig.sent_gyro().size() - gyro.size(), 6U);
  EXPECT_EQ(scanner.counters().bytes_skipped, 0U);
  for (std::size_t i = 0; i < rig.sent_frames().size(); ++i) EXPECT_EQ(rig.sent_frames()[i].index, i);
}

TEST(VirtualRig, KnowsTheTrueRateOfTheShaftOverEachExposure) {
  VirtualRig rig(default_rig(2, "kitchen"), sweep(100.0));
  rig.keep_truth(true);
  run(rig, 6.0, 0.02);
  EXPECT_NEAR(rig.sent_frames().front().mean_rate_dps, 0.0, 20.0);
  EXPECT_NEAR(rig.sent_frames().back().mean_rate_dps, 100.0, 6.0);
  EXPECT_NEAR(rig.sent_gyro().back().mean_rate_dps, 100.0, 25.0);
  ASSERT_NEAR(static_cast<double>(rig.shaft().size()), 6000.0, 2.0);
  const auto& last = rig.shaft().back();
  const auto& earlier = rig.shaft()[rig.shaft().size() - 1001];
  EXPECT_NEAR(last.angle_deg - earlier.angle_deg, 100.0, 6.0);
  EXPECT_EQ(last.time - earlier.time, from_s(1.0));
  EXPECT_NEAR(static_cast<double>(rig.pulses().size()), 300.0, 2.0);
}

TEST(VirtualRig, KeepsNoTruthUnlessAsked) {
  VirtualRig rig(default_rig(2, "kitchen"), sweep(100.0));
  run(rig, 1.0, 0.02);
  EXPECT_TRUE(rig.shaft().empty());
  EXPECT_TRUE(rig.sent_frames().empty());
  EXPECT_TRUE(rig.sent_gyro().empty());
  EXPECT_TRUE(rig.pulses().empty());
}

TEST(VirtualRig, BringsBytesToTheServoAfterTheirTimeOnTheWire) {
  auto firmware = std::make_unique<ScriptedFirmware>(nullptr);
  ScriptedFirmware* servo = firmware.get();
  VirtualRig rig(default_rig(2, "laboratory"), std::move(firmware));
  rig.advance(at_s(0.5));
  rig.send(Device::servo, std::vector<std::uint8_t>{1, 2, 3}, at_s(0.5));
  const auto answers = rig.advance(at_s(0.6));
  ASSERT_EQ(servo->received.size(), 3U);
  EXPECT_GE(servo->received[0].time_us,
            500'030);  // a byte at 250000 baud takes 40 us, the crystal may be slow
  EXPECT_LE(servo->received[0].time_us, 501'150);
  EXPECT_NEAR(static_cast<double>(servo->received[2].time_us - servo->received[0].time_us), 80.0, 2.0);
  EXPECT_EQ(bytes_of(answers, Device::servo), (std::vector<std::uint8_t>{2, 3, 4}));
}

TEST(VirtualRig, LeavesBytesToCameraAndGyroUnanswered) {
  VirtualRig asked(default_rig(2, "laboratory"), sweep(0.0));
  VirtualRig left_alone(default_rig(2, "laboratory"), sweep(0.0));
  asked.send(Device::camera, test::camera_command(gy_mcu90640::command_read_emissivity, 1), at_s(0.0));
  asked.send(Device::gyro, std::vector<std::uint8_t>{0xFF, 0xAA}, at_s(0.0));
  expect_equal(run(asked, 1.0, 0.1), run(left_alone, 1.0, 0.1));
}

TEST(VirtualRig, SkipsEverySecondHalfFreshFrameThatDoesNotFitItsLine) {
  // A real board at 115200 baud that is asked for 8 frames a second sends 3.92, with both halves fresh.
  auto config = default_rig(2, "dining");
  config.profile.camera.link.baud = 115200;
  VirtualRig rig(config, sweep(0.0));
  const auto frames = frames_of(run(rig, 20.0, 0.1));
  EXPECT_NEAR(static_cast<double>(frames.size()), 20.0 * 3.92, 2.0);
  for (const auto& message : frames) EXPECT_TRUE(message.fresh.both_fresh());
}

TEST(VirtualRig, StartsAtItsHostTime) {
  auto config = default_rig(2, "dining");
  config.start = at_s(1000.0);
  VirtualRig rig(config, sweep(0.0));
  const auto chunks = rig.advance(at_s(1001.0));
  ASSERT_FALSE(chunks.empty());
  EXPECT_GE(chunks.front().arrived, at_s(1000.0));
  VirtualRig early(default_rig(2, "dining"), sweep(0.0));
  EXPECT_EQ(bytes_of(chunks, Device::camera), bytes_of(early.advance(at_s(1.0)), Device::camera));
}

TEST(DefaultRig, IsTheWinchWithTheNarrowLensAndAWitmotionGyro) {
  const VirtualRigConfig config = default_rig(3, "garden");
  EXPECT_EQ(config.profile.camera.link.baud, 460800U);
  EXPECT_EQ(config.profile.camera.field_of_view_deg, 55.0);
  EXPECT_EQ(config.profile.servo.travel_deg, 2160.0);
  EXPECT_EQ(config.profile.servo.link.baud, 250000U);
  EXPECT_EQ(config.profile.gyro.output_rate_hz, 200.0);
  EXPECT_EQ(config.gyro_grade, GyroGrade::typical);
  EXPECT_TRUE(config.half_fresh && config.warm);
}

}  // namespace
}  // namespace thermorig::simulation

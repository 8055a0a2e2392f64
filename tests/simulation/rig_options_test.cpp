// SPDX-License-Identifier: MIT
// What a test can ask of the rig beyond its seed: latencies, outages, hand turns, a gyro that zeroes itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include "scripted_firmware.h"
#include "support/at_s.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {
namespace {

/// A rig whose shaft rests, after it ran for some time.
std::unique_ptr<VirtualRig> run_resting(const VirtualRigConfig& config, double seconds,
                                        std::vector<Chunk>* chunks = nullptr) {
  auto firmware = std::make_unique<ScriptedFirmware>([](double) { return 0.0; }, config.profile.servo);
  auto rig = std::make_unique<VirtualRig>(config, std::move(firmware));
  rig->keep_truth(true);
  auto arrived = rig->advance(at_s(seconds));
  if (chunks != nullptr) *chunks = std::move(arrived);
  return rig;
}

template <typename Scanner, typename Message>
std::vector<Message> decoded(Scanner scanner, const std::vector<Chunk>& chunks, Device device) {
  std::vector<Message> messages;
  for (const Chunk& chunk : chunks)
    if (chunk.device == device) scanner.push(chunk.bytes, messages);
  scanner.finish(messages);
  return messages;
}

TEST(RigLatency, IsTheOneThatIsSetPlusTheBoardsJitter) {
  auto config = default_rig(4, "garden");
  config.camera_latency_s = 0.033;
  config.gyro_latency_s = 0.004;
  const auto rig = run_resting(config, 5.0);
  for (const SentMessage& frame : rig->sent_frames()) {
    EXPECT_GE(to_s(frame.sent - frame.exposure_end), 0.033 - 1e-8);
    EXPECT_LE(to_s(frame.sent - frame.exposure_end), 0.035 + 1e-8);
  }
  for (const SentMessage& sample : rig->sent_gyro()) {
    EXPECT_GE(to_s(sample.sent - sample.exposure_end), 0.004 - 1e-8);
    EXPECT_LE(to_s(sample.sent - sample.exposure_end), 0.0042 + 1e-8);
  }
}

TEST(RigLatency, ChangesNothingElseThatTheSeedDraws) {
  auto config = default_rig(4, "garden");
  const auto drawn = run_resting(config, 2.0);
  config.camera_latency_s = 0.033;
  config.gyro_latency_s = 0.004;
  const auto set = run_resting(config, 2.0);
  for (std::size_t i = 0; i < set->sent_frames().size(); ++i)
    EXPECT_EQ(set->sent_frames()[i].exposure_end, drawn->sent_frames()[i].exposure_end);
  for (std::size_t i = 0; i < set->sent_gyro().size(); ++i)
    EXPECT_EQ(set->sent_gyro()[i].exposure_end, drawn->sent_gyro()[i].exposure_end);
}

TEST(RigOutage, TakesTheFramesInItAndNoOthersAndTheRestIsFoundByItsBytes) {
  auto config = default_rig(4, "garden");
  config.outages = {{Device::camera, at_s(4.0), at_s(9.0)}};
  std::vector<Chunk> chunks;
  const auto rig = run_resting(config, 15.0, &chunks);
  const auto frames =
      decoded<wire::CameraScanner, wire::CameraMessage>(wire::CameraScanner(), chunks, Device::camera);
  const auto& sent = rig->sent_frames();
  std::size_t whole = 0, next = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].index, i);
    const bool outside = sent[i].sent + from_s(0.034) < at_s(4.0) || sent[i].sent > at_s(9.0);
    EXPECT_TRUE(sent[i].arrives || !outside) << i;
    const bool inside = sent[i].sent > at_s(4.0) && sent[i].sent < at_s(8.96);
    EXPECT_TRUE(sent[i].span.size() == 0 || !inside) << i;
    whole += sent[i].arrives ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(sent.size() - whole), 5.0 * 7.84, 1.5);
  ASSERT_GE(frames.size() + 1, whole);  // the last one may be on its way
  for (const auto& frame : frames) {
    while (next < sent.size() && !(sent[next].arrives && sent[next].span == frame.span)) ++next;
    ASSERT_LT(next, sent.size());
  }
  for (const Chunk& chunk : chunks)
    EXPECT_FALSE(chunk.device == Device::camera && chunk.arrived > at_s(4.15) && chunk.arrived < at_s(9.0));
}

TEST(RigOutage, LeavesTheOtherDevicesAlone) {
  auto config = default_rig(4, "garden");
  std::vector<Chunk> undisturbed, disturbed;
  run_resting(config, 5.0, &undisturbed);
  config.outages = {{Device::camera, at_s(1.0), at_s(3.0)}};
  run_resting(config, 5.0, &disturbed);
  const auto is_camera = [](const Chunk& chunk) { return chunk.device == Device::camera; };
  std::erase_if(undisturbed, is_camera);
  std::erase_if(disturbed, is_camera);
  ASSERT_EQ(undisturbed.size(), disturbed.size());
  for (std::size_t i = 0; i < disturbed.size(); ++i) {
    EXPECT_EQ(disturbed[i].arrived, undisturbed[i].arrived);
    EXPECT_EQ(disturbed[i].bytes, undisturbed[i].bytes);
  }
}

TEST(RigHandTurn, IsSeenByTheGyroAndByTheTruth) {
  auto config = default_rig(4, "garden");
  config.hand_turns = {{.begin = at_s(2.0), .duration_s = 6.0, .angle_deg = -360.0}};
  std::vector<Chunk> chunks;
  const auto rig = run_resting(config, 10.0, &chunks);
  const auto& shaft = rig->shaft();
  EXPECT_NEAR(shaft[9500].angle_deg - shaft[1900].angle_deg, -360.0, 0.5);
  EXPECT_NEAR(shaft[4999].rate_dps, -120.0, 0.5);
  const auto gyro = decoded<sensors::GyroScanner, wire::GyroMessage>(
      sensors::gyro_scanner(config.profile.gyro), chunks, Device::gyro);
  const auto rate_dps = [&](std::size_t i) { return static_cast<double>(gyro[i].reading.rate_dps[2]); };
  double turned_deg = 0.0, bias_dps = 0.0;
  for (std::size_t i = 200; i < 380; ++i) bias_dps += rate_dps(i) / 180.0;  // the servo has gone to its angle
  for (std::size_t i = 380; i < gyro.size(); ++i) turned_deg += (rate_dps(i) - bias_dps) / 200.0;
  EXPECT_NEAR(turned_deg, -360.0, 12.0);
  double seen_deg = 0.0;
  for (const SentMessage& sample : rig->sent_gyro())
    seen_deg += sample.mean_rate_dps * to_s(sample.exposure_end - sample.exposure_begin);
  EXPECT_NEAR(seen_deg, shaft.back().angle_deg - shaft.front().angle_deg, 0.5);
}

TEST(RigGyro, ThatZeroesItselfShowsExactZerosAfterASecondAtRestUntilItTurns) {
  auto config = default_rig(4, "garden");
  config.gyro_zeroes_itself = true;
  config.hand_turns = {{.begin = at_s(4.0), .duration_s = 3.0, .angle_deg = 90.0}};
  std::vector<Chunk> chunks;
  run_resting(config, 10.0, &chunks);
  const auto gyro = decoded<sensors::GyroScanner, wire::GyroMessage>(
      sensors::gyro_scanner(config.profile.gyro), chunks, Device::gyro);
  const auto zeros = [&](double from_s, double to_s) {
    int count = 0;
    for (auto i = static_cast<std::size_t>(200.0 * from_s); i < static_cast<std::size_t>(200.0 * to_s); ++i)
      count += gyro[i].reading.counts == std::array<std::int16_t, 3>{} ? 1 : 0;
    return count;
  };
  EXPECT_EQ(zeros(0.0, 0.9), 0);
  EXPECT_EQ(zeros(2.0, 4.0), 400);
  EXPECT_EQ(zeros(4.5, 7.8), 0);
  EXPECT_EQ(zeros(8.1, 9.5), 280);
}

TEST(RigServoClock, IsReadWhereTelemetryLeft) {
  VirtualRig rig(default_rig(4, "garden"), make_host_firmware());
  wire::ServoScanner scanner;
  std::vector<wire::ServoMessage> messages;
  double least_s = 1.0;
  for (const Chunk& chunk : rig.advance(at_s(20.0))) {
    if (chunk.device != Device::servo) continue;
    messages.clear();
    scanner.push(chunk.bytes, messages);
    for (const auto& message : messages) {
      if (!std::holds_alternative<ServoState>(message.body)) continue;
      const auto mcu_us = std::get<ServoState>(message.body).mcu_us;
      const HostTime left = rig.when_servo_clock_read(ServoTime(ServoTime::duration(mcu_us)));
      least_s = std::min(least_s, to_s(chunk.arrived - left));
    }
  }
  EXPECT_GT(least_s, 0.0008);  // 22 bytes at 250000 baud
  EXPECT_LT(least_s, 0.0050);
}

}  // namespace
}  // namespace thermorig::simulation

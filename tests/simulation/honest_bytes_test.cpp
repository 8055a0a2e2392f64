// SPDX-License-Identifier: MIT
// The honest world sends what the simulated rig has always sent, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <string>

#include "scripted_firmware.h"
#include "support/at_s.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {
namespace {

/// FNV-1a.
class Digest {
 public:
  void add(std::uint64_t word) {
    for (int i = 0; i < 8; ++i) add_byte(static_cast<std::uint8_t>(word >> (8 * i)));
  }
  void add(HostTime time) { add(static_cast<std::uint64_t>(time.time_since_epoch().count())); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add_byte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3ULL; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325ULL;
};

/// Of all that arrives in 12 s, when it arrives, and of the truth behind it.
std::uint64_t digest_of(const VirtualRigConfig& config) {
  auto to_and_fro = [](double time_s) { return 60.0 * std::sin(2.0 * std::max(0.0, time_s - 1.0)); };
  VirtualRig rig(config, std::make_unique<ScriptedFirmware>(to_and_fro, config.profile.servo));
  rig.keep_truth(true);
  Digest digest;
  for (int second = 0; second < 12; ++second) {
    rig.send(Device::servo, std::vector<std::uint8_t>{1, 2, 3}, at_s(second));
    for (const Chunk& chunk : rig.advance(at_s(second + 1))) {
      digest.add(std::uint64_t{index_of(chunk.device)});
      digest.add(chunk.arrived);
      for (const std::uint8_t byte : chunk.bytes) digest.add_byte(byte);
    }
  }
  for (const auto* sent : {&rig.sent_frames(), &rig.sent_gyro()})
    for (const SentMessage& message : *sent) {
      digest.add(message.exposure_begin);
      digest.add(message.exposure_end);
      digest.add(message.mean_rate_dps);
    }
  for (const TruthSample& sample : rig.shaft()) {
    digest.add(sample.angle_deg);
    digest.add(sample.rate_dps);
  }
  return digest.value();
}

class HonestWorld : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __x86_64__
    if (!__builtin_cpu_supports("fma"))
      GTEST_SKIP() << "the C library computes otherwise: the last bits differ";
#else
    GTEST_SKIP() << "other processors fuse multiplications and additions: the last bits differ";
#endif
  }
};

TEST_F(HonestWorld, SendsWhatTheDefaultRigHasAlwaysSent) {
  EXPECT_EQ(digest_of(default_rig(1, "kitchen")), 0x2E98F48DCD6892F5ULL);
  EXPECT_EQ(digest_of(default_rig(2, "garden")), 0x844E9D5490AF9DC3ULL);
}

TEST_F(HonestWorld, SendsWhatOtherRigsHaveAlwaysSent) {
  auto config = default_rig(3, "dining");
  config.gyro_grade = GyroGrade::mpu6050_raw;
  config.gyro_zeroes_itself = true;
  config.half_fresh = false;
  config.warm = false;
  config.profile.camera.field_of_view_deg = 110.0;
  config.profile.camera.mirrored = false;
  config.hand_turns = {{.begin = at_s(3.0), .duration_s = 4.0, .angle_deg = 90.0}};
  config.outages = {{Device::gyro, at_s(5.0), at_s(6.0)}};
  config.links[Device::servo] = {.kind = UsbLink::cdc, .loaded_host = true};
  EXPECT_EQ(digest_of(config), 0x48E58040701CFFF3ULL);
}

TEST_F(HonestWorld, SendsWhatAContinuousServoHasAlwaysTurned) {
  auto config = default_rig(4, "laboratory");
  config.profile.servo.kind = ServoKind::continuous;
  config.profile.servo.full_rate_dps = 240.0;
  EXPECT_EQ(digest_of(config), 0x5EA7BFCEE1804F77ULL);
}

}  // namespace
}  // namespace thermorig::simulation

// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>

#include "dead_firmware.h"
#include "simulation/simulated_ports/avr_firmware.h"
#include "virtual_ports.h"

namespace thermorig {
namespace {

using namespace std::chrono_literals;

class ServedWith : public testing::TestWithParam<FirmwareChoice> {
 protected:
  void SetUp() override {
    if (GetParam() == FirmwareChoice::avr_image && !make_avr_firmware())
      GTEST_SKIP() << "thermorig-avr or the AVR image is not built";
  }
};

INSTANTIATE_TEST_SUITE_P(Firmware, ServedWith,
                         testing::Values(FirmwareChoice::avr_image, FirmwareChoice::host_build),
                         [](const auto& choice) {
                           return choice.param == FirmwareChoice::avr_image ? "AvrImage" : "HostBuild";
                         });

TEST_P(ServedWith, GivesAProgramFramesGyroPacketsAndTelemetry) {
  VirtualPorts ports(make_firmware(GetParam()));
  ports.open_all();
  ports.let_pass(1s);
  ports.write(Device::servo, wire::hello_bytes(0));
  ports.let_pass(1s);
  EXPECT_EQ(ports.heard().count<wire::ServoWelcome>(), 1U);
  EXPECT_GE(ports.heard().frames.size(), 14U);         // at 8 Hz, of a clock that is 2 % slow
  EXPECT_GE(ports.heard().gyro.size(), 390U);          // at 200 Hz
  EXPECT_GE(ports.heard().count<ServoState>(), 180U);  // at 100 Hz
  EXPECT_TRUE(ports.heard().is_undamaged());
}

TEST_P(ServedWith, IsNamedByItsFirmware) {
  EXPECT_EQ(make_firmware(GetParam())->description(),
            GetParam() == FirmwareChoice::avr_image ? "AVR image" : "host build");
}

TEST_P(ServedWith, TurnsTheServoThatTheProgramCommands) {
  VirtualPorts ports(make_firmware(GetParam()));
  const ServoProfile servo = simulation::default_profile().servo;
  ports.open_all();
  ports.let_pass(1s);
  ports.write(Device::servo, wire::hello_bytes(0));
  ports.write(Device::servo, wire::configure_bytes(1, servo));
  ports.write(Device::servo, wire::arm_bytes(2, 0.0));
  ports.write(Device::servo, wire::run_bytes(3, {.leg = 1,
                                                 .turn_back = true,
                                                 .rate_dps = 90.0,
                                                 .acceleration_dps2 = servo.acceleration_dps2,
                                                 .duration_s = 5.0}));
  for (int refreshes = 0; refreshes < 100; ++refreshes) {
    ports.let_pass(20ms);
    ports.write(Device::servo, wire::refresh_bytes());
  }
  EXPECT_EQ(ports.heard().count<wire::ServoNack>(), 0U);
  EXPECT_EQ(ports.heard().count<wire::ServoAck>(), 3U);
  const auto* state = std::get_if<ServoState>(&ports.heard().servo.back().body);
  ASSERT_NE(state, nullptr);
  EXPECT_GT(state->angle_deg, 60.0);
  EXPECT_FALSE(ports.server().rig().pulses().empty());
  double fastest_dps = 0.0;
  for (const auto& sample : ports.server().rig().shaft())
    fastest_dps = std::max(fastest_dps, sample.rate_dps);
  EXPECT_GT(fastest_dps, 80.0);
  EXPECT_LT(fastest_dps, 110.0);
}

TEST(RigServer, DeliversEveryByteThatTheTallyCounts) {
  VirtualPorts ports;
  ports.open_all();
  ports.write(Device::servo, wire::hello_bytes(0));
  ports.let_pass(1s);
  const ServingTally tally = ports.server().tally();
  for (const Device device : all_devices) {
    const Bytes& delivered = ports.server().delivered(device);
    EXPECT_GT(delivered.size(), 1000U) << name_of(device);
    EXPECT_EQ(ports.heard().bytes[device], delivered) << name_of(device);
    EXPECT_EQ(tally.ports[device].bytes_delivered, delivered.size()) << name_of(device);
    EXPECT_EQ(tally.ports[device].bytes_overrun + tally.ports[device].bytes_unheard, 0U) << name_of(device);
  }
  EXPECT_EQ(tally.ports[Device::servo].bytes_received, wire::hello_bytes(0).size());
}

TEST(RigServer, SendsEveryFrameAndSampleThatTheRigRemembers) {
  VirtualPorts ports;
  ports.open_all();
  ports.let_pass(2s);
  const auto& sent_frames = ports.server().rig().sent_frames();
  const auto& sent_gyro = ports.server().rig().sent_gyro();
  ASSERT_GE(sent_frames.size(), ports.heard().frames.size());
  ASSERT_GE(sent_gyro.size(), ports.heard().gyro.size());
  EXPECT_LE(sent_frames.size() - ports.heard().frames.size(), 2U);  // on their way
  EXPECT_LE(sent_gyro.size() - ports.heard().gyro.size(), 8U);
  for (std::size_t i = 0; i < ports.heard().frames.size(); ++i)
    EXPECT_EQ(ports.heard().frames[i].span, sent_frames[i].span) << i;
  for (std::size_t i = 0; i < ports.heard().gyro.size(); ++i)
    EXPECT_EQ(ports.heard().gyro[i].span, sent_gyro[i].span) << i;
}

TEST(RigServer, CountsHowLateItIsCalled) {
  VirtualPorts ports;
  ports.open_all();
  ports.let_pass(1s);
  const ServingTally in_time = ports.server().tally();
  EXPECT_GT(in_time.chunks, 100U);
  EXPECT_DOUBLE_EQ(in_time.elapsed_s, 1.0);
  EXPECT_LE(in_time.worst_lag_s, 0.001);
  EXPECT_LE(in_time.mean_lag_s, in_time.worst_lag_s);
  ports.stand_still(300ms);
  ports.let_pass(1ms);
  EXPECT_GT(ports.server().tally().worst_lag_s, 0.25);
  EXPECT_LE(ports.server().tally().worst_lag_s, 0.301);
}

TEST(RigServer, CatchesUpWithAPause) {
  VirtualPorts ports;
  ports.open_all();
  ports.let_pass(1s);
  ports.stand_still(500ms);
  ports.let_pass(500ms);
  EXPECT_GE(ports.heard().gyro.size(), 390U);  // at 200 Hz, all two seconds
  EXPECT_TRUE(ports.heard().is_undamaged());
}

TEST(RigServer, DropsWhatNoProgramHears) {
  VirtualPorts ports;
  ports.let_pass(1s);
  const ServingTally tally = ports.server().tally();
  for (const PortTally& port : tally.ports.values) {
    EXPECT_GT(port.bytes_unheard, 0U);
    EXPECT_EQ(port.bytes_delivered + port.bytes_overrun, 0U);
  }
  EXPECT_EQ(tally.chunks, 0U);
}

constexpr std::size_t waiting_max = 48 * 1024;

TEST(RigServer, CountsWhatAProgramThatDoesNotReadOverruns) {
  VirtualPorts ports;
  ports.open_all();
  ports.stop_reading(Device::camera);
  ports.let_pass(10s);  // 120 KiB of frames
  const PortTally full = ports.server().tally().ports[Device::camera];
  EXPECT_EQ(full.bytes_delivered, ports.line(Device::camera).room);
  EXPECT_EQ(full.bytes_delayed, waiting_max);
  EXPECT_GT(full.bytes_overrun, 30'000U);
  EXPECT_EQ(ports.server().tally().ports[Device::gyro].bytes_overrun, 0U);
}

TEST(RigServer, DeliversWhatWaitedInOrderOnceTheProgramReadsAgain) {
  VirtualPorts ports;
  ports.open_all();
  ports.stop_reading(Device::camera);
  ports.let_pass(3s);  // 36 KiB of frames
  EXPECT_GT(ports.server().tally().ports[Device::camera].bytes_delayed, 10'000U);
  ports.read_again(Device::camera);
  ports.let_pass(1s);
  EXPECT_EQ(ports.server().tally().ports[Device::camera].bytes_overrun, 0U);
  EXPECT_GE(ports.heard().frames.size(), 30U);  // at 8 Hz, all four seconds
  EXPECT_TRUE(ports.heard().is_undamaged());
}

TEST(RigServer, GoesOnAfterAPortWasClosedAndOpenedAgain) {
  VirtualPorts ports;
  ports.open_all();
  ports.let_pass(1s);
  const std::size_t before = ports.heard().gyro.size();
  ports.close(Device::gyro);
  ports.let_pass(1s);
  EXPECT_EQ(ports.heard().gyro.size(), before);
  EXPECT_GT(ports.server().tally().ports[Device::gyro].bytes_unheard, 1000U);
  ports.line(Device::gyro).is_open = true;
  ports.let_pass(1s);
  EXPECT_GE(ports.heard().gyro.size(), before + 195U);
}

TEST(RigServer, LosesTheUnpluggedDeviceOnlyUntilItIsPutBack) {
  VirtualPorts ports;
  ports.open_all();
  ports.let_pass(1s);
  const std::size_t gyro_before = ports.heard().gyro.size(), frames_before = ports.heard().frames.size();
  ports.server().unplug(Device::gyro);
  ports.let_pass(1s);
  EXPECT_FALSE(ports.line(Device::gyro).is_plugged);
  EXPECT_TRUE(ports.line(Device::camera).is_plugged);
  EXPECT_TRUE(ports.line(Device::servo).is_plugged);
  EXPECT_EQ(ports.heard().gyro.size(), gyro_before);
  EXPECT_GE(ports.heard().frames.size(), frames_before + 7);
  ports.plug_in(Device::gyro);
  ports.line(Device::gyro).is_open = true;
  ports.let_pass(1s);
  EXPECT_GE(ports.heard().gyro.size(), gyro_before + 195U);
}

TEST(RigServer, UnplugsAllPortsAndSaysWhyWhenTheMicroControllerDies) {
  VirtualPorts ports(std::make_unique<DeadFirmware>());
  ports.open_all();
  EXPECT_THROW(ports.let_pass(1s), Error);
  for (const Device device : all_devices) EXPECT_FALSE(ports.line(device).is_plugged) << name_of(device);
}

}  // namespace
}  // namespace thermorig

// SPDX-License-Identifier: MIT
#include "thermorig/simulated_ports/simulated_ports.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <thread>

#include "thermorig/core/error.h"
#include "thermorig/io/port.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/simulated_ports/avr_firmware.h"
#include "thermorig/wire/camera_scanner.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int patience_ticks = 10'000;  // of a millisecond

void run_until(io::Loop& loop, const std::function<bool()>& done) {
  int ticks = 0;
  bool finished = false;
  loop.every(std::chrono::milliseconds(1), [&](HostTime) {
    finished = done();
    if (finished || ++ticks > patience_ticks) loop.stop();
  });
  loop.run();
  loop.every(std::chrono::milliseconds(1), [](HostTime) {});
  EXPECT_TRUE(finished) << "what the test waits for did not happen";
}

void wait_until(const std::function<bool()>& done) {
  io::Loop loop;
  run_until(loop, done);
}

/// A program that has opened the three ports as if they were real.
class Listener {
 public:
  explicit Listener(const PerDevice<std::string>& paths) {
    for (const Device device : all_devices) open(device, paths[device]);
  }

  void run_until(const std::function<bool()>& done) { thermorig::run_until(loop_, done); }
  void write(Device device, const Bytes& command) { loop_.write(ids_[device], command); }

  template <typename Body>
  std::size_t count() const {
    return static_cast<std::size_t>(std::count_if(servo.begin(), servo.end(), [](const auto& message) {
      return std::holds_alternative<Body>(message.body);
    }));
  }

  PerDevice<Bytes> bytes;
  PerDevice<int> losses;
  std::vector<wire::CameraMessage> frames;
  std::vector<wire::GyroMessage> gyro;
  std::vector<wire::ServoMessage> servo;
  wire::CameraScanner camera_scanner;
  sensors::GyroScanner gyro_scanner = sensors::gyro_scanner(simulation::default_profile().gyro);
  wire::ServoScanner servo_scanner;

 private:
  void open(Device device, const std::string& path) {
    PortProfile link = simulation::default_profile().link(device);
    link.port = path;
    ids_[device] = loop_.open(
        link, {[this, device](std::span<const std::uint8_t> chunk, HostTime) { take(device, chunk); },
               [this, device](const std::string&) { ++losses[device]; }});
  }

  void take(Device device, std::span<const std::uint8_t> chunk) {
    bytes[device].insert(bytes[device].end(), chunk.begin(), chunk.end());
    if (device == Device::camera) camera_scanner.push(chunk, frames);
    if (device == Device::gyro) gyro_scanner.push(chunk, gyro);
    if (device == Device::servo) servo_scanner.push(chunk, servo);
  }

  PerDevice<io::Loop::PortId> ids_;
  io::Loop loop_;
};

simulation::VirtualRigConfig rig_config() {
  return simulation::default_rig(3, "garden");
}

/// Says hello and listens until every device has been heard for a while.
void hear_all_devices(Listener& program) {
  program.write(Device::servo, wire::hello_bytes(0));
  program.run_until([&] {
    return program.frames.size() >= 4 && program.gyro.size() >= 80 && program.count<ServoState>() >= 40 &&
           program.count<wire::ServoWelcome>() == 1;
  });
}

class SimulatedPortsWith : public testing::TestWithParam<FirmwareChoice> {
 protected:
  void SetUp() override {
    if (GetParam() == FirmwareChoice::avr_image && !make_avr_firmware())
      GTEST_SKIP() << "thermorig-avr or the AVR image is not built";
  }
};

INSTANTIATE_TEST_SUITE_P(Firmware, SimulatedPortsWith,
                         testing::Values(FirmwareChoice::avr_image, FirmwareChoice::host_build),
                         [](const auto& choice) {
                           return choice.param == FirmwareChoice::avr_image ? "AvrImage" : "HostBuild";
                         });

TEST_P(SimulatedPortsWith, GiveAProgramFramesGyroPacketsAndTelemetry) {
  SimulatedPorts ports(rig_config(), GetParam());
  ports.start();
  Listener program(ports.paths());
  hear_all_devices(program);
  EXPECT_EQ(program.camera_scanner.counters().bad_checksum, 0U);
  EXPECT_EQ(program.gyro_scanner.counters().bad_checksum, 0U);
  EXPECT_EQ(program.servo_scanner.counters().bad_checksum, 0U);
  EXPECT_EQ(program.servo_scanner.counters().lost, 0U);
}

TEST_P(SimulatedPortsWith, SayWhichFirmwareRuns) {
  const SimulatedPorts ports(rig_config(), GetParam());
  EXPECT_EQ(ports.firmware_description(),
            GetParam() == FirmwareChoice::avr_image ? "AVR image" : "host build");
}

TEST_P(SimulatedPortsWith, TurnTheServoThatTheProgramCommands) {
  SimulatedPorts ports(rig_config(), GetParam());
  ports.keep_truth();
  ports.start();
  Listener program(ports.paths());
  const ServoProfile servo = simulation::default_profile().servo;
  program.write(Device::servo, wire::hello_bytes(0));
  program.write(Device::servo, wire::configure_bytes(1, servo));
  program.write(Device::servo, wire::arm_bytes(2, 0.0));
  program.write(Device::servo, wire::run_bytes(3, {.leg = 1,
                                                   .turn_back = true,
                                                   .rate_dps = 90.0,
                                                   .acceleration_dps2 = servo.acceleration_dps2,
                                                   .duration_s = 5.0}));
  int ticks = 0;
  program.run_until([&] {
    if (++ticks % 20 == 0) program.write(Device::servo, wire::refresh_bytes());
    const auto* state = program.servo.empty() ? nullptr : std::get_if<ServoState>(&program.servo.back().body);
    return state != nullptr && state->angle_deg > 60.0;
  });
  ports.stop();
  EXPECT_EQ(program.count<wire::ServoNack>(), 0U);
  EXPECT_EQ(program.count<wire::ServoAck>(), 3U);
  EXPECT_FALSE(ports.rig().pulses().empty());
  double fastest_dps = 0.0;
  for (const auto& sample : ports.rig().shaft()) fastest_dps = std::max(fastest_dps, sample.rate_dps);
  EXPECT_GT(fastest_dps, 80.0);
}

TEST(SimulatedPorts, DeliverEveryByteThatTheTallyCounts) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.keep_truth();
  ports.start();
  Listener program(ports.paths());
  hear_all_devices(program);
  ports.stop();
  const ServingTally tally = ports.tally();
  for (const Device device : all_devices) {
    const Bytes& delivered = ports.delivered(device);
    program.run_until([&] { return program.bytes[device].size() >= delivered.size(); });
    EXPECT_EQ(program.bytes[device], delivered) << name_of(device);
    EXPECT_EQ(tally.ports[device].bytes_delivered, delivered.size()) << name_of(device);
    EXPECT_EQ(tally.ports[device].bytes_overrun, 0U) << name_of(device);
  }
  EXPECT_EQ(tally.ports[Device::servo].bytes_received, wire::hello_bytes(0).size());
}

TEST(SimulatedPorts, SendEveryFrameAndSampleThatTheRigRemembers) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.keep_truth();
  ports.start();
  Listener program(ports.paths());
  hear_all_devices(program);
  ports.stop();
  // Before the ports were open nothing was heard; what the rig sent last may still be on its way.
  EXPECT_GE(ports.rig().sent_frames().size(), program.frames.size());
  EXPECT_GE(ports.rig().sent_gyro().size(), program.gyro.size());
  EXPECT_LE(ports.rig().sent_frames().front().exposure_end, io::now());
}

TEST(SimulatedPorts, DropWhatNoProgramHears) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.start();
  wait_until([&] {
    const ServingTally tally = ports.tally();
    return std::all_of(tally.ports.values.begin(), tally.ports.values.end(),
                       [](const PortTally& port) { return port.bytes_unheard > 0; });
  });
  const ServingTally tally = ports.tally();
  for (const PortTally& port : tally.ports.values) EXPECT_EQ(port.bytes_delivered + port.bytes_overrun, 0U);
  EXPECT_EQ(tally.chunks, 0U);
}

TEST(SimulatedPorts, CountWhatAProgramThatDoesNotReadOverruns) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.start();
  const int idle_program = open(ports.paths()[Device::camera].c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(idle_program, 0);
  wait_until([&] { return ports.tally().ports[Device::camera].bytes_overrun > 0; });
  close(idle_program);
  EXPECT_GT(ports.tally().ports[Device::camera].bytes_delivered, 1000U);
}

TEST(SimulatedPorts, GoOnAfterAPortWasClosedAndOpenedAgain) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.start();
  for (int opened = 0; opened < 2; ++opened) {
    Listener program(ports.paths());
    program.run_until([&] { return !program.frames.empty() && !program.gyro.empty(); });
  }
}

TEST(SimulatedPorts, LoseTheUnpluggedDeviceOnly) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.start();
  Listener program(ports.paths());
  ports.unplug(Device::gyro);
  program.run_until([&] { return program.losses[Device::gyro] > 0; });
  program.run_until([&, before = program.frames.size()] { return program.frames.size() > before + 1; });
  EXPECT_THAT(program.losses.values, testing::ElementsAre(0, 1, 0));
}

/// A micro-controller whose process has died.
class DeadFirmware : public simulation::Firmware {
 public:
  void receive(std::uint8_t, std::int64_t) override {}
  simulation::FirmwareOutput run_until(std::int64_t) override {
    throw Error(ExitCode::failed, "the simulated micro-controller stopped", "", "");
  }
  std::string description() const override { return "dead"; }
};

TEST(SimulatedPorts, UnplugThemselvesAndSayWhyWhenTheMicroControllerDies) {
  SimulatedPorts ports(rig_config(), std::make_unique<DeadFirmware>());
  Listener program(ports.paths());
  ports.start();
  program.run_until([&] {
    return std::all_of(program.losses.values.begin(), program.losses.values.end(),
                       [](int n) { return n == 1; });
  });
  EXPECT_THROW(ports.stop(), Error);
}

}  // namespace
}  // namespace thermorig

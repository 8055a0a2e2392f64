// SPDX-License-Identifier: MIT
// The rig on pseudo terminals and the wall clock: what rig_server_test.cpp cannot show.
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "dead_firmware.h"
#include "heard.h"
#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig {
namespace {

constexpr int patience_ticks = 10'000;  // of a millisecond

/// A program that has opened the three ports as if they were real.
class Listener {
 public:
  explicit Listener(const PerDevice<std::string>& paths) {
    for (const Device device : all_devices) open(device, paths[device]);
  }

  void run_until(const std::function<bool()>& done) {
    int ticks = 0;
    bool finished = false;
    loop_.every(std::chrono::milliseconds(1), [&](HostTime) {
      finished = done();
      if (finished || ++ticks > patience_ticks) loop_.stop();
    });
    loop_.run();
    loop_.every(std::chrono::milliseconds(1), [](HostTime) {});
    EXPECT_TRUE(finished) << "what the test waits for did not happen";
  }

  void write(Device device, const Bytes& command) { loop_.write(ids_[device], command); }

  Heard heard;
  PerDevice<int> losses;

 private:
  void open(Device device, const std::string& path) {
    PortProfile link = simulation::default_profile().link(device);
    link.port = path;
    ids_[device] = loop_.open(
        link, {[this, device](std::span<const std::uint8_t> chunk, HostTime) { heard.take(device, chunk); },
               [this, device](const std::string&) { ++losses[device]; }});
  }

  PerDevice<io::Loop::PortId> ids_;
  io::Loop loop_;
};

TEST(SimulatedPorts, GiveAProgramEveryByteOfARigWithTheAvrImage) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::avr_image);  // the host build where it is not built
  EXPECT_EQ(ports.firmware_description(), make_firmware(FirmwareChoice::avr_image)->description());
  ports.keep_truth();
  ports.start();
  Listener program(ports.paths());
  program.write(Device::servo, wire::hello_bytes(0));
  program.run_until([&, &heard = program.heard] {
    return heard.frames.size() >= 4 && heard.gyro.size() >= 80 && heard.count<ServoState>() >= 40 &&
           heard.count<wire::ServoWelcome>() == 1 && ports.tally().chunks > 0;
  });
  ports.stop();
  for (const Device device : all_devices) {
    const Bytes& delivered = ports.delivered(device);
    program.run_until([&] { return program.heard.bytes[device].size() >= delivered.size(); });
    EXPECT_EQ(program.heard.bytes[device], delivered) << name_of(device);
    EXPECT_EQ(ports.tally().ports[device].bytes_overrun, 0U) << name_of(device);
  }
  EXPECT_TRUE(program.heard.is_undamaged());
  // Rig time is host time.
  EXPECT_LE(ports.rig().sent_frames().back().exposure_end, io::now());
  EXPECT_GT(ports.rig().sent_frames().back().exposure_end, io::now() - std::chrono::hours(1));
}

TEST(SimulatedPorts, LoseTheUnpluggedDeviceOnly) {
  SimulatedPorts ports(rig_config(), FirmwareChoice::host_build);
  ports.start();
  Listener program(ports.paths());
  ports.unplug(Device::gyro);
  program.run_until([&] { return program.losses[Device::gyro] > 0; });
  program.run_until(
      [&, before = program.heard.frames.size()] { return program.heard.frames.size() > before + 1; });
  EXPECT_THAT(program.losses.values, testing::ElementsAre(0, 1, 0));
}

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

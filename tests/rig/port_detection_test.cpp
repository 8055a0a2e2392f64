// SPDX-License-Identifier: MIT
// Which device speaks on which port: found by listening at one baud rate after the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "simulation/gyro.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

class Detection : public ::testing::Test {
 protected:
  std::vector<PortFinding> identify(const std::vector<std::string>& paths) {
    std::vector<io::PortInfo> infos;
    for (const std::string& path : paths) infos.push_back({.path = path});
    return identify_devices(infos, ports_);
  }

  VirtualPorts ports_{simulation::default_rig(1, "kitchen")};
};

TEST_F(Detection, TellsTheDevicesByWhatTheySend) {
  const auto& paths = ports_.paths();
  const auto findings =
      identify({paths[Device::servo], paths[Device::camera], paths[Device::gyro], "/dev/pts/987654"});
  ASSERT_EQ(findings.size(), 4U);
  EXPECT_EQ(findings[0].role, Device::servo);
  EXPECT_EQ(findings[1].role, Device::camera);
  EXPECT_EQ(findings[2].role, Device::gyro);
  EXPECT_NEAR(findings[1].rate_hz, 8.0, 1.5);
  EXPECT_THAT(findings[1].how, HasSubstr("camera frame(s), checksums good"));
  EXPECT_FALSE(findings[3].role);
  EXPECT_FALSE(findings[3].problem.empty());
}

TEST_F(Detection, FindsTheBaudRateOfEachDevice) {
  const RigProfile profile = simulation::default_profile();
  for (const Device device : all_devices) ports_.set_baud(device, profile.link(device).baud);
  for (const Device device : all_devices) {
    const auto findings = identify({ports_.paths()[device]});
    EXPECT_EQ(findings.at(0).role, device) << findings[0].how;
    EXPECT_EQ(findings[0].baud, profile.link(device).baud);
  }
}

TEST(DetectionOfACamera, AsksOneThatIsSilentForFramesAndLeavesOthersAlone) {
  for (const auto start : {simulation::CameraStart::when_asked, simulation::CameraStart::by_itself})
    for (const std::uint32_t baud : {0U, 115200U}) {
      auto config = simulation::default_rig(1, "kitchen");
      config.camera_start = start;
      config.profile.camera.output_rate_hz = 4.0;
      VirtualPorts ports(config);
      if (baud != 0) ports.set_baud(Device::camera, baud);
      const auto findings = identify_devices({{.path = ports.paths()[Device::camera]}}, ports);
      EXPECT_EQ(findings.at(0).role, Device::camera) << findings[0].how;
      EXPECT_EQ(findings[0].baud, baud);
      EXPECT_EQ(ports.written(Device::camera).empty(), start == simulation::CameraStart::by_itself);
    }
}

TEST_F(Detection, OfASilentPortSaysThatItWasSilent) {
  const auto findings = identify({ports_.add([] { return std::vector<std::uint8_t>(); })});
  EXPECT_FALSE(findings.at(0).role);
  EXPECT_EQ(findings[0].problem, "");
  EXPECT_EQ(findings[0].how, "silent at 2 baud rates");
}

TEST_F(Detection, FindsARoleTwiceAndTakesNeither) {
  const auto packet = wire::witmotion_gyro_packet({1, 2, 3}, 30.0F);
  const auto gyro = [&] { return std::vector<std::uint8_t>(packet.begin(), packet.end()); };
  const auto findings = identify({ports_.add(gyro), ports_.add(gyro)});
  std::vector<std::string> ambiguous;
  EXPECT_EQ(apply_findings(RigProfile{}, findings, ambiguous).gyro.link.port, "");
  ASSERT_EQ(ambiguous.size(), 1U);
  EXPECT_THAT(ambiguous[0], HasSubstr("2 ports look like a gyro: "));
}

/// 50 lines a second; the unit of their clock shows in how long they took.
TEST_F(Detection, GuessesTheColumnsOfAGyroThatPrintsLines) {
  const auto lines = [ms = 1000]() mutable {
    ms += 20;
    const std::string line = fmt::format("{},0.5,-1.25,{}\r\n", ms, ms % 3);
    return std::vector<std::uint8_t>(line.begin(), line.end());
  };
  const auto findings = identify({ports_.add(lines)});
  EXPECT_EQ(findings.at(0).protocol, "text");
  ASSERT_TRUE(findings[0].text_format) << findings[0].how;
  EXPECT_THAT(findings[0].text_format->sample_line, HasSubstr(",0.5,-1.25,"));
  EXPECT_EQ(findings[0].text_format->columns.rate, (std::array<int, 3>{1, 2, 3}));
  EXPECT_EQ(findings[0].text_format->columns.time, 0);
  EXPECT_EQ(findings[0].text_format->columns.time_unit_s, 1e-3);
}

TEST_F(Detection, KnowsAFlightController) {
  const auto findings = identify({ports_.add([sample = simulation::SimulatedGyroSample()]() mutable {
    ++sample.index;
    sample.device_time_us += 20'000;
    const GyroProfile profile{.protocol = "mavlink", .output_rate_hz = 50.0};
    return simulation::gyro_encoder(profile).bytes(sample, profile);
  })});
  EXPECT_EQ(findings.at(0).role, Device::gyro);
  EXPECT_THAT(findings[0].how, HasSubstr("MAVLink packets"));
  std::vector<std::string> ambiguous;
  EXPECT_EQ(apply_findings(RigProfile{}, findings, ambiguous).gyro.protocol, "mavlink");
}

}  // namespace
}  // namespace thermorig::rig::test

// SPDX-License-Identifier: MIT
// Which device speaks on which port: found by listening at one baud rate after the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  EXPECT_EQ(findings[0].how, "silent at 7 baud rates");
}

/// A port with a wire, on which what is heard depends on the baud rate.
class PortsWithAWire : public VirtualPorts {
 public:
  using VirtualPorts::VirtualPorts;
  PortId open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) override {
    baud = link.baud;
    return VirtualPorts::open(link, std::move(handlers), refusal);
  }
  bool has_baud(const std::string&) const override { return true; }

  std::uint32_t baud = 0;
};

/// At a wrong baud rate bits fall together: frames of a length remain, with bytes that are always the same.
std::vector<std::uint8_t> misheard(int number) {
  std::vector<std::uint8_t> bytes{0xF7, 0x9E};
  for (int i = 2; i < 16; ++i) bytes.push_back(static_cast<std::uint8_t>(37 * number + i * i * (number + 5)));
  return bytes;
}

TEST(DetectionAtAWrongBaudRate, GoesOnWhereTheBytesHaveAMarkThatNobodyKnows) {
  for (const std::uint32_t right_baud : {9600U, 0U}) {
    PortsWithAWire ports{simulation::default_rig(1, "kitchen")};
    const std::string path = ports.add([&ports, right_baud, number = 0]() mutable {
      const auto packet = wire::witmotion_gyro_packet({1, 2, static_cast<std::int16_t>(++number)}, 30.0F);
      const std::vector<std::uint8_t> right(packet.begin(), packet.end());
      return ports.baud == right_baud ? right : misheard(number);
    });
    const PortFinding finding = identify_devices({{.path = path}}, ports).at(0);
    EXPECT_EQ(finding.baud, right_baud) << finding.how;
    EXPECT_EQ(finding.role.has_value(), right_baud != 0) << finding.how;
    EXPECT_THAT(finding.how, HasSubstr(right_baud != 0 ? "WitMotion" : "the mark F7 9E"));
    EXPECT_EQ(finding.advice.empty(), right_baud != 0);
  }
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
  EXPECT_FALSE(findings[0].is_known());
  EXPECT_NEAR(findings[0].rate_hz, 50.0, 1.0);
}

TEST_F(Detection, MeasuresTheRateOfABoardThatBootsFirst) {
  const auto boots = [tick = 0]() mutable {
    const std::string line = ++tick < 20 ? "" : fmt::format("gx:{}.5 gy:1 gz:2 dps\r\n", tick % 7);
    return std::vector<std::uint8_t>(line.begin(), line.end());
  };
  const auto findings = identify({ports_.add(boots)});
  EXPECT_EQ(findings.at(0).role, Device::gyro);
  EXPECT_TRUE(findings[0].is_known()) << findings[0].how;
  EXPECT_NEAR(findings[0].rate_hz, 50.0, 2.0);
}

TEST_F(Detection, WaitsForASketchThatPrintsTwiceASecond) {
  const auto slow = [tick = 0]() mutable {
    std::string line;
    if (++tick % 25 == 0)
      line = fmt::format("temp: 25\r\nRotation X: 0.{}, Y: 0.02, Z: 0.03 rad/s\r\n\r\n", tick % 7);
    return std::vector<std::uint8_t>(line.begin(), line.end());
  };
  const auto findings = identify({ports_.add(slow)});
  EXPECT_EQ(findings.at(0).role, Device::gyro) << findings[0].how;
  EXPECT_NEAR(findings[0].rate_hz, 2.0, 0.3);
}

/// Ten bare columns, of which the seventh is the rate about the vertical axis, in counts of 1/65.5 deg/s. It
/// lies still for two seconds and turns by 100 deg in the next two.
std::vector<std::uint8_t> turned_line(double seconds) {
  const double phase = std::clamp((seconds - 2.0) / 2.0, 0.0, 1.0);
  const double rate_dps = 100.0 * 0.5 * (1.0 - std::cos(2.0 * std::numbers::pi * phase));
  const double angle = 100.0 * (phase - std::sin(2.0 * std::numbers::pi * phase) / (2.0 * std::numbers::pi));
  const double heading = (angle + 20.0) * std::numbers::pi / 180.0;
  const int wobble = static_cast<int>(seconds * 1000.0) % 7 - 3;
  const std::string line =
      fmt::format("{:.0f},{:.2f},{:.2f},{:.2f},{},{},{:.0f},{:.2f},{:.2f},{:.2f}\r\n", seconds * 1e3,
                  0.01 * wobble, -0.02 * wobble, 9.81 + 0.01 * wobble, wobble, 40 - wobble,
                  -65.5 * rate_dps + wobble, 20.0 * std::cos(heading), 20.0 * std::sin(heading), angle);
  return {line.begin(), line.end()};
}

TEST_F(Detection, FindsTheColumnAndTheUnitThatATurnByHandShows) {
  PortFinding finding;
  finding.info.path = ports_.add([tick = 0]() mutable { return turned_line(0.02 * ++tick); });
  finding.role = Device::gyro;
  finding.protocol = "text";
  std::vector<std::uint8_t> still;
  for (int i = 1; i < 50; ++i) {
    const auto line = turned_line(0.02 * i);
    still.insert(still.end(), line.begin(), line.end());
  }
  finding.text_format = classify(still).found.text_format;
  ASSERT_TRUE(finding.text_format.has_value());
  ASSERT_FALSE(finding.is_known());
  const auto turned = hear_hand_turn(finding, ports_);
  ASSERT_TRUE(turned.has_value());
  EXPECT_TRUE(turned->is_known());
  EXPECT_EQ(turned->text_format->columns.rate, (std::array<int, 3>{4, 5, 6}));
  EXPECT_EQ(turned->axis, 2);
  EXPECT_NEAR(turned->text_format->columns.scale_dps, 1.0 / 65.5, 1e-9);
  EXPECT_THAT(turned->text_format->assumptions,
              ::testing::ElementsAre(HasSubstr("column 6 turned, by 100 deg")));
  std::vector<std::string> ambiguous;
  EXPECT_EQ(apply_findings(RigProfile{}, {*turned}, ambiguous).gyro.text.rate[2], 6);
}

TEST_F(Detection, LearnsNothingOfAGyroThatNobodyTurned) {
  PortFinding finding;
  finding.info.path = ports_.add([tick = 0]() mutable { return turned_line(0.001 * (++tick % 1000)); });
  finding.text_format = classify(turned_line(0.02)).found.text_format.value_or(sensors::TextFormat());
  finding.text_format->fields = 10;
  EXPECT_FALSE(hear_hand_turn(finding, ports_).has_value());
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

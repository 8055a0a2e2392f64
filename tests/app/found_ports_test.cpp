// SPDX-License-Identifier: MIT
// What `thermorig ports` says of devices that it heard.
#include "record/found_ports.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "rig/virtual_ports.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::uint8_t> silence() {
  return {};
}

std::vector<std::uint8_t> gyro_words() {
  const auto packet = wire::witmotion_gyro_packet({1, 2, 3}, 30.0F);
  return {packet.begin(), packet.end()};
}

/// A gyro that prints a line with a number that grows; 50 lines a second.
rig::test::VirtualPorts::Speaker gyro_lines(const char* format) {
  return [format, ms = 1000]() mutable {
    ms += 20;
    const std::string line = fmt::format(fmt::runtime(format), ms);
    return std::vector<std::uint8_t>(line.begin(), line.end());
  };
}

class PortsThatWereHeard : public ::testing::Test {
 protected:
  FoundPorts found(const std::vector<std::string>& paths, const SavedProfile& saved = {}) {
    std::vector<io::PortInfo> infos;
    for (const std::string& path : paths) infos.push_back({.path = path});
    return found_ports(rig::identify_devices(infos, ports_), RigProfile{}, saved);
  }

  rig::test::VirtualPorts ports_{simulation::default_rig(3, "garden")};
};

TEST(FoundPorts, ThatMayNotBeOpenedEndWithAnotherCodeThanMissingOnes) {
  const auto code = [](ExitCode of_port) {
    rig::PortFinding finding{.info = {.path = "/dev/ttyUSB0"},
                             .problem = "port is in use by process 7 (cat)"};
    finding.code = of_port;
    return found_ports({finding}, RigProfile{}, {}).code();
  };
  EXPECT_EQ(code(ExitCode::no_permission), ExitCode::no_permission);
  EXPECT_EQ(code(ExitCode::device_missing), ExitCode::device_missing);
}

TEST_F(PortsThatWereHeard, AreToldInTheOrderOfTheirRolesWithWhatToTypeNext) {
  const auto& paths = ports_.paths();
  const FoundPorts rig = found({paths[Device::servo], paths[Device::gyro], paths[Device::camera]});
  EXPECT_TRUE(rig.is_whole_rig());
  const std::string text = text_of(rig);
  EXPECT_LT(text.find("camera "), text.find("gyro "));
  EXPECT_LT(text.find("gyro "), text.find("servo "));
  EXPECT_THAT(text, Not(HasSubstr("missing")));
  EXPECT_THAT(text,
              HasSubstr("next  thermorig record --environment kitchen --camera " + paths[Device::camera]));
  EXPECT_THAT(text, HasSubstr("save  thermorig ports " + paths[Device::camera] + " "))
      << "as they were named";
  EXPECT_EQ(json_of(rig)["ports"][0]["role"], "camera");
}

TEST_F(PortsThatWereHeard, AreToldWithTheRolesThatAreMissing) {
  const FoundPorts gyro_alone = found({ports_.add(silence), ports_.add(gyro_words)});
  EXPECT_FALSE(gyro_alone.is_whole_rig());
  const std::string text = text_of(gyro_alone);
  EXPECT_THAT(text, HasSubstr("missing  camera, servo\n  try: "));
  EXPECT_THAT(text, Not(HasSubstr("next  thermorig record")));
  EXPECT_THAT(text, HasSubstr("unknown"));
  EXPECT_LT(text.find("gyro "), text.find("unknown"));
  EXPECT_EQ(json_of(gyro_alone)["missing"], nlohmann::json({"camera", "servo"}));
}

TEST_F(PortsThatWereHeard, OfOneRoleAreNotedAndNothingToRecordWithIsSuggested) {
  const auto& paths = ports_.paths();
  const FoundPorts two_gyros =
      found({paths[Device::camera], paths[Device::servo], ports_.add(gyro_words), ports_.add(gyro_words)},
            {"./found.toml", "./found.toml"});
  EXPECT_FALSE(two_gyros.is_whole_rig());
  const std::string text = text_of(two_gyros);
  EXPECT_THAT(text, HasSubstr("2 ports look like a gyro: "));
  EXPECT_THAT(text, HasSubstr("saved ./found.toml"));
  EXPECT_THAT(text, Not(HasSubstr("next  thermorig record")));
  EXPECT_EQ(json_of(two_gyros)["saved"], "./found.toml");
}

TEST_F(PortsThatWereHeard, BringTheColumnsOfATextGyroIntoTheProfileWhereItsLinesSayThem) {
  const FoundPorts text_gyro = found({ports_.add(gyro_lines("gx:{}.5,gy:-1.25,gz:0.5 rad/s\r\n"))});
  const std::string text = text_of(text_gyro);
  EXPECT_THAT(text, HasSubstr(".5,gy:-1.25,"));
  EXPECT_THAT(text, HasSubstr("why: columns 0,1,2 are the rates by the words \"gx\"; their unit is rad/s"));
  EXPECT_THAT(text, HasSubstr("taken: no prefix, columns 0,1,2 as x,y,z, 57.2958 deg/s a unit"));
  const std::string profile = rig::profile_text(text_gyro.profile);
  EXPECT_THAT(profile, HasSubstr("protocol = \"text\""));
  EXPECT_THAT(profile, HasSubstr("output_rate_hz = 50"));
  EXPECT_EQ(json_of(text_gyro)["ports"][0]["text_format"]["columns"], nlohmann::json({0, 1, 2}));
}

TEST_F(PortsThatWereHeard, SaveNoTextGyroThatIsAGuessAndSayWhichLinesToFillIn) {
  const FoundPorts bare =
      found({ports_.add(gyro_lines("{},0.5,-1.25,0.75\r\n"))}, {"./found.toml", "./found.toml"});
  const std::string text = text_of(bare);
  EXPECT_THAT(text, HasSubstr("not taken: the lines do not say which columns are the rates"));
  EXPECT_THAT(text, HasSubstr("z_column = 3  # a guess"));
  EXPECT_THAT(text, HasSubstr("scale_dps = ?  # 1 for deg/s, 57.2958 for rad/s"));
  EXPECT_EQ(bare.profile.gyro.link.port, "");
  const FoundPorts counts = found({ports_.add(gyro_lines("GyX = {} | GyY = 2 | GyZ = 3\r\n"))});
  EXPECT_THAT(text_of(counts), HasSubstr("scale_dps = ?  # 1/131 = 0.00763359"));
  EXPECT_EQ(counts.profile.gyro.link.port, "");
  EXPECT_EQ(json_of(counts)["ports"][0]["text_format"]["scale_known"], false);
}

TEST_F(PortsThatWereHeard, TellWhatToDoAboutWhatCannotBeRecorded) {
  const FoundPorts angles = found({ports_.add(gyro_lines("ypr\t{}.5\t2.10\t3.20\r\n"))});
  const std::string text = text_of(angles);
  EXPECT_THAT(
      text,
      HasSubstr("sends lines of text: its lines hold angles, no rates of turn\n  try: make the sketch"));
  EXPECT_THAT(text, HasSubstr("missing  camera, gyro, servo"));
  EXPECT_NE(json_of(angles)["ports"][0]["advice"], "");
}

}  // namespace
}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
// What `thermorig ports` says of devices that it heard.
#include "record/found_ports.h"

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

/// A gyro that prints its milliseconds and three rates; 50 lines a second.
rig::test::VirtualPorts::Speaker gyro_lines() {
  return [ms = 1000]() mutable {
    ms += 20;
    const std::string line = std::to_string(ms) + ",0.5,-1.25," + std::to_string(ms % 3) + "\r\n";
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

TEST_F(PortsThatWereHeard, BringTheColumnsOfATextGyroIntoTheProfileToBeChecked) {
  const FoundPorts text_gyro = found({ports_.add(gyro_lines())});
  const std::string text = text_of(text_gyro);
  EXPECT_THAT(text, HasSubstr(",0.5,-1.25,"));
  EXPECT_THAT(text, HasSubstr("taken: no prefix, columns 1,2,3 as x,y,z, 1 deg/s a unit, time in column 0 "
                              "(0.001 s"));
  EXPECT_THAT(text, HasSubstr("check scale and columns"));
  const std::string profile = rig::profile_text(text_gyro.profile);
  EXPECT_THAT(profile, HasSubstr("x_column = 1"));
  EXPECT_THAT(profile, HasSubstr("z_column = 3"));
  EXPECT_THAT(profile, HasSubstr("time_column = 0"));
  EXPECT_EQ(json_of(text_gyro)["ports"][0]["text_format"]["columns"], nlohmann::json({1, 2, 3}));
}

}  // namespace
}  // namespace thermorig::app

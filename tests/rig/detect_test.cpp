// SPDX-License-Identifier: MIT
#include "thermorig/rig/discovery/detect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "simulated_bus.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

/// Half a second of what one device of a simulated rig sends, from the middle of a message on.
std::vector<std::uint8_t> bytes_of(
    Device device, double duration_s = 0.5,
    const simulation::VirtualRigConfig& config = simulation::default_rig(1, "kitchen")) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  std::vector<std::uint8_t> bytes;
  for (const Chunk& chunk : rig.advance(HostTime{} + from_s(1.0 + duration_s)))
    if (chunk.device == device && to_s(chunk.arrived - HostTime{}) > 1.0)
      bytes.insert(bytes.end(), chunk.bytes.begin(), chunk.bytes.end());
  bytes.erase(bytes.begin(), bytes.begin() + 5);
  return bytes;
}

std::vector<std::uint8_t> as_bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

TEST(Classify, TellsTheThreeDevicesApart) {
  for (const Device device : all_devices) {
    const Evidence evidence = classify(bytes_of(device));
    EXPECT_EQ(evidence.role, device) << name_of(device) << ": " << evidence.found.text;
  }
  EXPECT_EQ(classify(bytes_of(Device::gyro)).protocol, "witmotion");
}

TEST(Classify, KnowsAGyroThatPrintsLines) {
  std::string text = "initialising I2C devices...\r\n";
  for (int i = 0; i < 20; ++i) text += "a/g:\t-124\t88\t16012\t-33\t" + std::to_string(i) + "\t7\r\n";
  const Evidence evidence = classify(as_bytes(text));
  EXPECT_EQ(evidence.role, Device::gyro);
  EXPECT_EQ(evidence.protocol, "text");
  EXPECT_EQ(evidence.found.messages, 20U);
  ASSERT_TRUE(evidence.found.text_format.has_value());
  EXPECT_EQ(evidence.found.text_format->columns.prefix, "a/g:");
  EXPECT_EQ(evidence.found.text_format->columns.rate, (std::array<int, 3>{3, 4, 5}));
}

TEST(Classify, TellsTheUnitOfATextGyrosClockByHowLongItListened) {
  std::string text = "ms,gx,gy,gz\n";
  for (int i = 0; i < 20; ++i) text += std::to_string(1000 + 2 * i) + ",0.5,-1,2\n";
  EXPECT_EQ(classify(as_bytes(text), 0.04).found.text_format->columns.time_unit_s, 1e-3);
}

TEST(Classify, KnowsAFlightController) {
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.profile.gyro.protocol = "mavlink";
  const Evidence evidence = classify(bytes_of(Device::gyro, 0.5, config));
  EXPECT_EQ(evidence.role, Device::gyro);
  EXPECT_EQ(evidence.protocol, "mavlink");
  EXPECT_GE(evidence.found.messages, 98U);
  EXPECT_GT(evidence.explained_share, 0.95);
}

TEST(Classify, DoesNotGuess) {
  EXPECT_FALSE(classify({}).role);
  EXPECT_EQ(classify({}).found.text, "silent");
  std::vector<std::uint8_t> noise;
  std::uint32_t random = 7;
  for (int i = 0; i < 20000; ++i)
    noise.push_back(static_cast<std::uint8_t>((random = random * 1664525U + 1013904223U) >> 24U));
  EXPECT_FALSE(classify(noise).role);
  const Evidence text = classify(as_bytes("hello\nworld\nnothing here 1 2\nand more\n"));
  EXPECT_FALSE(text.role);
  EXPECT_THAT(text.found.text, HasSubstr("\"hello\""));
  EXPECT_THAT(text.found.advice, HasSubstr("its baud rate is right"));
  EXPECT_EQ(classify(noise).found.advice, "");
  auto wrong_baud = bytes_of(Device::camera);
  for (std::uint8_t& byte : wrong_baud) byte = static_cast<std::uint8_t>(byte & 0xB6U);
  EXPECT_FALSE(classify(wrong_baud).role);
}

TEST(Classify, KnowsTheRealCamera) {
  const char* given = std::getenv("THERMORIG_CAPTURES");
  const std::filesystem::path folder =
      std::filesystem::path(given ? given : THERMORIG_CAPTURES_DEFAULT) / "gy_mcu90640_serial";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no captures in " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bin") continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(classify(std::span(bytes).first(std::min<std::size_t>(bytes.size(), 6000))).role,
              Device::camera)
        << entry.path();
  }
}

PortFinding finding(const std::string& path, Device device, std::uint32_t baud) {
  PortFinding found;
  found.info.path = path;
  found.info.usb_path = "1-4";
  found.role = device;
  found.baud = baud;
  found.protocol = sensors::device_stream(device, RigProfile()).protocol;
  return found;
}

const RigProfile default_profile;

TEST(Findings, BecomeTheProfile) {
  std::vector<std::string> ambiguous;
  const std::vector<PortFinding> findings{finding("/dev/ttyUSB0", Device::gyro, 9600),
                                          finding("/dev/ttyUSB1", Device::camera, 115200), PortFinding{}};
  const RigProfile profile = apply_findings(default_profile, findings, ambiguous);
  EXPECT_EQ(profile.gyro.link.port, "/dev/ttyUSB0");
  EXPECT_EQ(profile.gyro.link.baud, 9600U);
  EXPECT_EQ(profile.camera.link.port, "/dev/ttyUSB1");
  EXPECT_EQ(profile.camera.link.baud, 115200U);
  EXPECT_EQ(profile.servo.link.port, "");
  EXPECT_TRUE(ambiguous.empty());
}

PortFinding text_gyro_finding() {
  PortFinding found = finding("/dev/ttyUSB0", Device::gyro, 115200);
  found.protocol = "text";
  found.text_format.emplace();
  found.text_format->columns.rate = {1, 2, 3};
  found.text_format->columns.time = 0;
  found.text_format->rates_known = found.text_format->scale_known = true;
  found.rate_hz = 98.63;
  return found;
}

TEST(Classify, GivesNoRoleToWhatCannotBeRecordedButAnAdvice) {
  std::string angles, pairs;
  for (int i = 10; i < 40; ++i) angles += "ypr\t" + std::to_string(i) + ".5\t2.1\t3.2\r\n";
  for (int i = 10; i < 40; ++i) pairs += "55 52 " + std::to_string(i) + " 00 EC FF 00 08 5A 0A 07\n";
  for (const std::string& text : {angles, pairs}) {
    const Evidence evidence = classify(as_bytes(text));
    EXPECT_FALSE(evidence.role) << evidence.found.text;
    EXPECT_NE(evidence.found.advice, "");
  }
}

TEST(Findings, BringTheRateThatWasMeasuredUnlessItIsTheProfiles) {
  std::vector<std::string> ambiguous;
  EXPECT_DOUBLE_EQ(apply_findings(default_profile, {text_gyro_finding()}, ambiguous).gyro.output_rate_hz,
                   98.6);
  PortFinding packets = finding("/dev/ttyUSB0", Device::gyro, 115200);
  packets.protocol = "witmotion";
  packets.rate_hz = 197.0;
  EXPECT_EQ(apply_findings(default_profile, {packets}, ambiguous).gyro.output_rate_hz, 200.0);
  packets.protocol = "mavlink";  // which is told its rate
  packets.rate_hz = 10.0;
  packets.settings = {{"message", 27.0}};
  const RigProfile controller = apply_findings(default_profile, {packets}, ambiguous);
  EXPECT_EQ(controller.gyro.output_rate_hz, 200.0);
  EXPECT_EQ(controller.gyro.settings.at("message"), 27.0);
}

TEST(Findings, LeaveAGyroOutWhoseColumnsOrUnitAreAGuess) {
  std::vector<std::string> ambiguous;
  for (const bool rates_known : {false, true}) {
    PortFinding guessed = text_gyro_finding();
    guessed.text_format->rates_known = rates_known;
    guessed.text_format->scale_known = false;
    const RigProfile profile = apply_findings(default_profile, {guessed}, ambiguous);
    EXPECT_EQ(profile.gyro.link.port, "");
    EXPECT_EQ(profile.gyro.protocol, "witmotion");
    RigProfile edited;  // by a person who knows them
    edited.gyro.protocol = "text";
    edited.gyro.text.rate = {5, 6, 7};
    const RigProfile kept = apply_findings(edited, {guessed}, ambiguous);
    EXPECT_EQ(kept.gyro.link.port, "/dev/ttyUSB0");
    EXPECT_EQ(kept.gyro.text.rate, (std::array<int, 3>{5, 6, 7}));
  }
}

TEST(Findings, BringTheColumnsOfATextGyro) {
  std::vector<std::string> ambiguous;
  const RigProfile profile = apply_findings(default_profile, {text_gyro_finding()}, ambiguous);
  EXPECT_EQ(profile.gyro.protocol, "text");
  EXPECT_EQ(profile.gyro.text.rate, (std::array<int, 3>{1, 2, 3}));
  EXPECT_EQ(profile.gyro.text.time, 0);
}

TEST(Findings, OfAnotherProtocolTakeTheSettingsOfTheOldOneAway) {
  std::vector<std::string> ambiguous;
  RigProfile edited;
  edited.gyro.protocol = "mavlink";
  edited.gyro.settings = {{"system", 3.0}};
  PortFinding found = finding("/dev/ttyACM0", Device::gyro, 115200);
  found.protocol = "mavlink";
  EXPECT_EQ(apply_findings(edited, {found}, ambiguous).gyro.settings.at("system"), 3.0);
  found.protocol = "witmotion";
  const RigProfile profile = apply_findings(edited, {found}, ambiguous);
  EXPECT_EQ(profile.gyro.protocol, "witmotion");
  EXPECT_TRUE(profile.gyro.settings.empty());
}

TEST(Findings, KeepTheColumnsThatAPersonHasSet) {
  std::vector<std::string> ambiguous;
  RigProfile edited;
  edited.gyro.protocol = "text";
  edited.gyro.text.rate = {5, 6, 7};
  const RigProfile profile = apply_findings(edited, {text_gyro_finding()}, ambiguous);
  EXPECT_EQ(profile.gyro.text.rate, (std::array<int, 3>{5, 6, 7}));
}

TEST(Findings, LeaveARoleAloneThatWasFoundTwice) {
  std::vector<std::string> ambiguous;
  const RigProfile profile = apply_findings(
      default_profile,
      {finding("/dev/ttyUSB0", Device::camera, 9600), finding("/dev/ttyUSB1", Device::camera, 9600)},
      ambiguous);
  EXPECT_EQ(profile.camera.link.port, "");
  ASSERT_EQ(ambiguous.size(), 1U);
  EXPECT_THAT(ambiguous[0], HasSubstr("/dev/ttyUSB0 and /dev/ttyUSB1"));
}

TEST(Findings, NameEveryPortThatLooksLikeTheSameRole) {
  std::vector<std::string> ambiguous;
  apply_findings(default_profile,
                 {finding("/dev/a", Device::gyro, 9600), finding("/dev/b", Device::gyro, 9600),
                  finding("/dev/c", Device::gyro, 9600)},
                 ambiguous);
  ASSERT_EQ(ambiguous.size(), 1U);
  EXPECT_THAT(ambiguous[0], HasSubstr("3 ports look like a gyro: /dev/a, /dev/b and /dev/c;"));
}

}  // namespace
}  // namespace thermorig::rig::test

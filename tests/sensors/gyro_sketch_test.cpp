// SPDX-License-Identifier: MIT
// Text gyros that are named by the sketch whose lines they print, and lines that end with a sum.
#include "thermorig/sensors/gyro_sketch.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "support/gyro_scanners.h"
#include "thermorig/core/error.h"
#include "wire/scan.h"

namespace thermorig::test::gyro_sketch {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

GyroProfile chosen(const char* name) {
  GyroProfile profile;
  sensors::choose_gyro(name, profile);
  return profile;
}

Scan<wire::GyroMessage> scan(const GyroProfile& profile, const std::string& text) {
  return scan_any_chunking<wire::GyroMessage>(sensors::gyro_scanner(profile),
                                              ByteVector(text.begin(), text.end()), Stream::ends);
}

TEST(AGyroSketch, HasANameOfItsOwnAndGivesALineItsThreeRates) {
  std::set<std::string> names;
  for (const std::string& name : sensors::gyro_names()) EXPECT_TRUE(names.insert(name).second) << name;
  for (const sensors::GyroSketch& sketch : sensors::gyro_sketches()) {
    if (sketch.name.empty()) continue;
    const GyroProfile profile = chosen(std::string(sketch.name).c_str());
    EXPECT_EQ(profile.protocol, "text");
    EXPECT_EQ(profile.text, sketch.columns) << sketch.name;
    EXPECT_GE(profile.output_rate_hz, 1.0) << sketch.name;
  }
}

TEST(AGyroSketch, SetsColumnsUnitAndRates) {
  const GyroProfile profile = chosen("adafruit-mpu6050");
  EXPECT_EQ(profile.sketch, "adafruit-mpu6050");
  EXPECT_EQ(profile.model, "Adafruit_MPU6050, basic_readings");
  EXPECT_EQ(profile.link.baud, 115200U);
  EXPECT_EQ(profile.output_rate_hz, 2.0);
  const auto found = scan(profile,
                          "Acceleration X: 0.12, Y: -0.30, Z: 9.81 m/s^2\r\n"
                          "Rotation X: 0.01, Y: -0.02, Z: 0.35 rad/s\r\nTemperature: 28.41 degC\r\n\r\n"
                          "Rotation X: 0.02, Y: -0.02, Z: 0.35 rad/s\r\n");
  ASSERT_EQ(found.messages.size(), 2U);
  EXPECT_NEAR(found.messages[1].reading.rate_dps[0], 1.146, 1e-3);
  EXPECT_NEAR(found.messages[1].reading.rate_dps[2], 20.054, 1e-3);
}

TEST(AGyroSketch, IsNotReadWhereTheWordsOnItsLinesSayAnotherUnit) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += fmt::format("Rotation X: 0.{}, Y: -1.20, Z: 20.05 DPS\r\n", i);
  GyroProfile profile = chosen("adafruit-mpu6050");
  const auto found = scan(profile, text);
  EXPECT_THAT(found.messages, IsEmpty());
  EXPECT_EQ(found.counters.bad_value, 9U);
  const auto format = sensors::guess_text_format(ByteVector(text.begin(), text.end()));
  ASSERT_TRUE(format);
  EXPECT_THAT(sensors::contradiction(profile, *format),
              HasSubstr("adafruit-mpu6050 prints rad/s (57.2958 deg/s a unit), but these lines say 1 deg/s"));
  profile.text.scale_dps = 1.0;  // who says it himself is believed
  EXPECT_EQ(scan(profile, text).messages.size(), 9U);
}

TEST(AGyroSketch, IsNotReadWhereTheWordsNameOtherColumns) {
  std::string text;
  for (int i = 0; i < 9; ++i)
    text += fmt::format("GyroX:0.{},GyroY:-0.02,GyroZ:0.35 rad/s,AccelX:0.1,AccelY:0.2,AccelZ:9.8\r\n", i);
  EXPECT_THAT(scan(chosen("adafruit-mpu6050-plotter"), text).messages, IsEmpty());
}

TEST(AGyroSketch, ThatSubtractsABiasSaysSo) {
  for (const char* name : {"tockn-mpu6050", "mpu6050-light", "sparkfun-razor-m0"})
    EXPECT_THAT(sensors::remark_on_rates(chosen(name)), HasSubstr("bias")) << name;
  EXPECT_EQ(sensors::remark_on_rates(chosen("sparkfun-icm20948")), "");
  EXPECT_EQ(sensors::remark_on_rates(chosen("vectornav")), "");
  GyroProfile profile = chosen("vectornav");
  profile.settings["filtered"] = 1.0;
  EXPECT_THAT(sensors::remark_on_rates(profile), HasSubstr("filter"));
}

TEST(AGyroSketch, OfTwoDecimalsOfRadiansSaysWhatTheyCost) {
  EXPECT_THAT(sensors::remark_on_rates(chosen("adafruit-mpu6050")),
              testing::AllOf(HasSubstr("steps of 0.573 deg/s"), HasSubstr("Serial.print(rate, 4)")));
}

TEST(AGyroSketch, ThatPrintsFewerSamplesThanACameraFramesSaysSo) {
  EXPECT_THAT(sensors::remark_on_rates(chosen("tockn-mpu6050")),
              testing::AllOf(HasSubstr("a rate of 1 /s is too low"), HasSubstr("bias")));
  GyroProfile profile = chosen("tockn-mpu6050");
  profile.output_rate_hz = 50.0;
  EXPECT_THAT(sensors::remark_on_rates(profile), testing::Not(HasSubstr("too few")));
}

TEST(AGyroSketch, IsForgottenWhereAProtocolIsChosen) {
  GyroProfile profile = chosen("tockn-mpu6050");
  sensors::choose_gyro("xsens", profile);
  EXPECT_EQ(profile.protocol, "xsens");
  EXPECT_EQ(profile.sketch, "");
  EXPECT_EQ(profile.output_rate_hz, 100.0);
  try {
    sensors::choose_gyro("adafruit-mpu605", profile);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_THAT(error.advice(), HasSubstr("did you mean \"adafruit-mpu6050\"?"));
  }
}

std::string with_sum(const std::string& text, bool is_xor) {
  unsigned sum = 0;
  for (const char c : text)
    sum = is_xor ? sum ^ static_cast<std::uint8_t>(c) : (sum + static_cast<std::uint8_t>(c)) & 0xFFU;
  return fmt::format("${}*{:02X}\r\n", text, sum);
}

TEST(TheSumAtTheEndOfALine, IsCheckedOnceTwoLinesHaveShownWhichItIs) {
  for (const bool is_xor : {true, false}) {
    std::string text;
    for (int i = 0; i < 6; ++i) {
      std::string line = with_sum(fmt::format("GYRO,1.{},-0.50,20.05", i), is_xor);
      if (i == 4) line[8] = '7';
      text += line;
    }
    const auto found = scan({.protocol = "text", .text = {.prefix = "$GYRO,"}}, text);
    EXPECT_EQ(found.messages.size(), 5U);
    EXPECT_EQ(found.counters.bad_checksum, 1U);
  }
}

TEST(TheSumAtTheEndOfALine, IsNoneWhereItFitsNothing) {
  std::string text;
  for (int i = 0; i < 6; ++i) text += fmt::format("$GYRO,1.{},-0.50,20.05*{:02X}\r\n", i, 40 + i);
  const auto found = scan({.protocol = "text", .text = {.prefix = "$GYRO,"}}, text);
  EXPECT_EQ(found.messages.size(), 6U);
  EXPECT_EQ(found.counters.bad_checksum, 0U);
}

}  // namespace
}  // namespace thermorig::test::gyro_sketch

// SPDX-License-Identifier: MIT
// Layouts that are refused with the reason, asked about or doubted: nothing is guessed that could be wrong.
// All values are made up.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/gyro_scanners.h"
#include "thermorig/sensors/text_format.h"
#include "wire/scan.h"

namespace thermorig::test::doubtful_layouts {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::optional<sensors::TextFormat> guess(const std::string& text) {
  const ByteVector bytes(text.begin(), text.end());
  return sensors::guess_text_format(bytes, sensors::StreamStart::at_line_start, 0.4);
}

TEST(DoubtfulLayouts, OfCountsAskForTheRangeAndOfOtherNumbersForTheUnit) {
  const auto named = guess("GyX = 12 | GyY = -3 | GyZ = 7\nGyX = 11 | GyY = -4 | GyZ = 6\n");
  ASSERT_TRUE(named.has_value());
  EXPECT_THAT(sensors::open_question(*named), HasSubstr("(131, 65.5, 32.8, 16.4"));
  const auto json = guess("{\"gx\":0.1,\"gy\":0.2,\"gz\":0.3}\n{\"gx\":0.2,\"gy\":0.2,\"gz\":0.4}\n");
  ASSERT_TRUE(json.has_value());
  EXPECT_THAT(sensors::open_question(*json), HasSubstr("(deg/s, rad/s)"));
}

TEST(DoubtfulLayouts, WithoutRatesAreRefusedWithTheReason) {
  struct Refused {
    const char* line;
    const char* reason;
  };
  for (const Refused& refused :
       {Refused{"ypr\t{0:.2f}\t2.10\t-3.20", "angles"},
        Refused{"quat\t0.98\t0.{1}\t0.02\t0.03", "quaternions"},
        Refused{"euler\t{0:.2f}\t2.10\t-3.20", "angles"}, Refused{"#YPR={0:.2f},2.10,-3.20", "angles"},
        Refused{"Yaw, Pitch, Roll: {0:.2f}, 2.10, -3.20", "angles"},
        Refused{"X: {0:.2f} Y: 2.10 Z: -3.20\t\tCALIBRATION: Sys=3 Gyro=3 Accel=3 Mag=0", "angles"},
        Refused{"qW: 0.9999 qX: 0.{1} qY: 0.02 qZ: 0.03", "quaternions"},
        Refused{"gyroAngleX: {0:.2f} gyroAngleY: 2.10 gyroAngleZ: 3.20", "angles"},
        Refused{"ax:{0:.2f} ay:2.10 az:3.20", "accelerations"}}) {
    std::string text;
    for (int i = 10; i < 30; ++i) text += fmt::format(fmt::runtime(refused.line), 1.1 * i, i) + "\n";
    const auto format = guess(text);
    ASSERT_TRUE(format.has_value()) << refused.line;
    EXPECT_THAT(format->refusal, HasSubstr(refused.reason)) << refused.line;
    EXPECT_FALSE(format->is_known());
    EXPECT_THAT(format->advice, HasSubstr("rates"));
  }
}

/// `form` of the line's number, of two noisy values and of 1 and 2 by turns.
std::string lines(const char* form, int count = 40) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format(fmt::runtime(form), i, 0.01 * (i * 7 % 11), 0.01 * (i * 5 % 13), 1 + i % 2) + "\n";
  return text;
}

TEST(DoubtfulLayouts, OfSeveralSensorsByTurnsAreRefused) {
  for (const std::string& text : {lines("imu={3} gx={1:.2f} gy={2:.2f} gz=0.3 dps"),
                                  "ms,id,gx_dps,gy_dps,gz_dps\n" + lines("{0},{3},{1:.2f},{2:.2f},0.3")}) {
    const auto format = guess(text);
    ASSERT_TRUE(format.has_value());
    EXPECT_THAT(format->refusal, HasSubstr("several sensors")) << text.substr(0, 40);
  }
  EXPECT_THAT(guess(lines("id={0} gx={1:.2f} gy={2:.2f} gz=0.3 dps"))->refusal, IsEmpty()) << "a count";
  for (const char* form : {"IMU: 0.0{3} {1:.2f} {2:.2f} dps", "IMU: {3} 4 -{3}", "MPU6050: {3}\t-{3}\t0"})
    EXPECT_THAT(guess(lines(form))->refusal, testing::Not(HasSubstr("several"))) << form << ", at rest";
}

TEST(DoubtfulLayouts, OfAQuaternionInLettersHoldNoRates) {
  for (const char* form : {"w: 0.9950 x: {1:.4f} y: {2:.4f} z: 0.0100", "0.9950,{1:.4f},{2:.4f},0.0100"})
    EXPECT_THAT(guess(lines(form))->refusal, HasSubstr("quaternions")) << form;
  for (const char* form :
       {"id=1 gx=0.0{3} gy=0.01 gz=-0.0{3}", "1,0.0{3},0.01,-0.0{3}", "gz:0.0{3} ax:0.01 ay:0.00 az:1.00"})
    EXPECT_THAT(guess(lines(form))->refusal, testing::Not(HasSubstr("quaternions"))) << form << ", at rest";
}

TEST(DoubtfulLayouts, OfAKnownMarkAskForTheUnitWhereTheAccelerationsAreOfAnotherRange) {
  EXPECT_TRUE(guess(lines("a/g:\t-104\t52\t16500\t{0}\t5\t7"))->is_known());
  const std::string shock = "a/g:\t-104\t9000\t30500\t3\t5\t7\n";
  EXPECT_TRUE(guess(shock + lines("a/g:\t-104\t52\t16500\t{0}\t5\t7"))->is_known());
  EXPECT_FALSE(guess(lines("a/g:\t-26\t13\t4125\t{0}\t5\t7"))->is_known());
  EXPECT_FALSE(guess(lines("a/g:\t0.01\t0.02\t1.01\t{1:.2f}\t{2:.2f}\t0.5"))->is_known());
}

TEST(DoubtfulLayouts, WithSumsThatNeverFitSayThatTheyAreReadUnchecked) {
  EXPECT_THAT(guess(lines("$GYRO_DPS,{1:.2f},{2:.2f},{0}.5*1F"))->remarks, Contains(HasSubstr("unchecked")));
}

TEST(DoubtfulLayouts, WhoseKindsOfLinesBeginAlikeAreRefused) {
  std::string text;
  for (int i = 0; i < 20; ++i)
    text += fmt::format("Gyroscope:\n0.{0},0.2,0.3\nAccelerometer:\n0.01,0.{0},1.0\n", i + 10);
  const auto format = guess(text);
  ASSERT_TRUE(format.has_value());
  EXPECT_THAT(format->refusal, HasSubstr("begin alike"));
  std::string axes;
  for (int i = 10; i < 30; ++i)
    axes += fmt::format("Gyroscope:\n X: 0.{0} Y: 0.2 Z: 0.3\nAccelerometer:\n X: 0.01 Y: 0.{0} Z: 1.0\n", i);
  EXPECT_THAT(guess(axes)->refusal, HasSubstr("begin alike"));
  std::string units;
  for (int i = 10; i < 30; ++i) units += fmt::format("0.{0} 0.2 0.3 o/s\n0.01 0.{0} 1.0 G\n", i);
  EXPECT_THAT(guess(units)->refusal, HasSubstr("begin alike"));
  std::string log;
  for (int i = 10; i < 30; ++i)
    log += fmt::format(
        "I (10{0}) MPU: acc x=0.{0} y=0.2 z=9.8\nI (10{0}) MPU: gyro x=0.{0} y=0.2 z=0.3 dps, t=25.1\n", i);
  EXPECT_THAT(guess(log)->refusal, HasSubstr("begin alike"));
}

TEST(DoubtfulLayouts, WithDecimalCommasAreRefusedWhereSomethingElseSeparates) {
  for (const char* line :
       {"0,35;1,20;-3,{}", "12345\t0,35\t1,20\t-3,{}", "gx:0,35 gy:1,20 gz:-3,{}", "0,35, 1,20, -3,{}"}) {
    std::string text;
    for (int i = 10; i < 30; ++i) text += fmt::format(fmt::runtime(line), i) + "\n";
    const auto format = guess(text);
    ASSERT_TRUE(format.has_value()) << line;
    EXPECT_THAT(format->refusal, HasSubstr("decimal commas")) << line;
    const auto scan =
        scan_any_chunking<wire::GyroMessage>(text_scanner({}, sensors::StreamStart::at_line_start),
                                             ByteVector(text.begin(), text.end()), Stream::ends);
    EXPECT_EQ(scan.messages.size(), 0U) << line;
  }
  for (const char* line : {"0.35,1.20;-3.{}", "1,2,3;4,5,{}", "1, 2, {}"}) {
    std::string text;
    for (int i = 10; i < 30; ++i) text += fmt::format(fmt::runtime(line), i) + "\n";
    EXPECT_THAT(guess(text)->refusal, IsEmpty()) << line;
  }
}

TEST(DoubtfulLayouts, WhoseNumbersWouldBeReadWrongAreRefusedWithTheCause) {
  struct Refused {
    const char* line;
    const char* reason;
  };
  for (const Refused& refused :
       {Refused{"gx: - 0.{0} gy: 0.10 gz: - 0.20 dps", "a sign and its number"},
        Refused{"gx=\xE2\x88\x92"
                "0.{0} gy=0.10 gz=0.20 dps",
                "U+2212"},
        Refused{"gx=0x{0} gy=0xFF1A gz=0x0010", "hexadecimal"},
        Refused{"imu1 gx:0.{0} gy:0.1 gz:0.2 imu2 gx:0.{0} gy:0.2 gz:0.3 dps", "about one axis"},
        Refused{"gz(rad/s)=0.{0} gz(deg/s)=5.{0}", "about one axis"},
        Refused{"gx={0} gy=1,362 gz=5 mdps", "commas"}, Refused{"gx:{0} gy:65530 gz:3", "lost their sign"}}) {
    std::string text;
    for (int i = 10; i < 30; ++i) text += fmt::format(fmt::runtime(refused.line), i) + "\n";
    const auto format = guess(text);
    ASSERT_TRUE(format.has_value()) << refused.line;
    EXPECT_THAT(format->refusal, HasSubstr(refused.reason)) << refused.line;
    EXPECT_NE(format->advice, "") << refused.line;
    EXPECT_FALSE(format->is_known());
  }
}

TEST(DoubtfulLayouts, WhoseUnitChangesAreRefused) {
  std::string text;
  for (int i = 10; i < 30; ++i)
    text += fmt::format("gx:0.{} gy:0.1 gz:0.2 {}\n", i, i < 20 ? "rad/s" : "deg/s");
  EXPECT_THAT(guess(text)->refusal, HasSubstr("unit on its lines changes"));
}

TEST(DoubtfulLayouts, ReadNoNumberWithoutItsSign) {
  const std::string text = "1,2,- 3\n1,2,- 3\n4,5,6\n4,5,6\n";
  const auto scan =
      scan_any_chunking<wire::GyroMessage>(text_scanner({}, sensors::StreamStart::at_line_start),
                                           ByteVector(text.begin(), text.end()), Stream::ends);
  for (const auto& message : scan.messages) EXPECT_NE(message.reading.rate_dps[2], 3.0F);
}

TEST(DoubtfulLayouts, WhoseNamesAreOfOtherThingsAreAskedFor) {
  for (const char* const lines :
       {"ms,servo_deg,gyro_dps\n{0}0,90.{1},0.3{1}\n", "gyro_dps,servo_dps,temp\n0.3{1},20.{1},25.0\n",
        "Gyro dps off\n0.0{1},0.02,0.3{1}\n", "raw gyro data, divide by 131 to get deg/s\n10{1},200,30{1}\n",
        "wheel_left_omega: 100.{1} wheel_right_omega: 102.0 motor_omega: 1.{1} rad/s\n",
        "100.{1} deg/s, 90.00 deg, 50 deg/s\n",
        "target gx:1.{1} gy:2 gz:3 error gx:0.{1} gy:0.2 gz:0.3 dps\n",
        "gyro1:0.{1},gyro2:0.2,gyro3:0.3 deg/s\n", "0.{1} 0.2 0.3 gyro dps | 0.03 -0.2 0.94 acc g\n",
        "{{\"servo\":{{\"rate\":{{\"x\":0,\"y\":1,\"z\":100.{1}}},\"unit\":\"deg/s\"}}}}\n"}) {
    const std::string all(lines);
    const std::size_t end = all.find('\n') + 1;
    const std::string above = end < all.size() ? all.substr(0, end) : "",
                      line = above.empty() ? all : all.substr(end);
    std::string text = above;
    for (int i = 10; i < 40; ++i) text += fmt::format(fmt::runtime(line), i, i % 10);
    const auto format = guess(text);
    if (format) {
      EXPECT_FALSE(format->is_known()) << lines;
    }
  }
}

TEST(DoubtfulLayouts, WhoseHeadersDifferAreRefused) {
  std::string text = "gx,gy,gz [dps]\n";
  for (int i = 10; i < 30; ++i) text += fmt::format("5.{},1.2,3.{}\n", i, i);
  text += "gx,gy,gz [rad/s]\n";
  for (int i = 10; i < 30; ++i) text += fmt::format("0.0{},0.02,0.5{}\n", i, i);
  EXPECT_THAT(guess(text)->refusal, HasSubstr("two headers"));
}

TEST(DoubtfulLayouts, TakeARampForNoClock) {
  std::string text = "gx,gy,gz dps\n";
  for (int i = 0; i < 30; ++i) text += fmt::format("{:.2f},0.1{},0.2{},25.1\n", 0.1 * i * i, i % 7, i % 5);
  const auto format = guess(text);
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.time, -1);
  EXPECT_FALSE(format->is_known());
}

TEST(DoubtfulLayouts, OfASensorThatNeverMovesAreDoubted) {
  std::string text;
  for (int i = 0; i < 20; ++i)
    text += "AcX = -1 | AcY = -1 | AcZ = -1 | Tmp = 36.53 | GyX = -1 | GyY = -1 | GyZ = -1\n";
  EXPECT_THAT(guess(text)->remarks, Contains(HasSubstr("is the sensor connected?")));
}

TEST(DoubtfulLayouts, OfFewDecimalsAreRemarkedOnOnceWithTheCure) {
  const auto remarks = [](const char* line) {
    std::string text;
    for (int i = 0; i < 20; ++i) text += fmt::format(fmt::runtime(line), i % 3) + "\n";
    return guess(text)->remarks;
  };
  EXPECT_THAT(remarks("Gyro X: 0.0{} Y: 0.02 Z: 0.03 rad/s"),
              ElementsAre(AllOf(HasSubstr("0.573 deg/s"), HasSubstr("Serial.print"))));
  EXPECT_THAT(remarks("Gyro X: 0.000{} Y: 0.02 Z: 0.03 rad/s"), IsEmpty());
  EXPECT_THAT(remarks("Gyro X: 0.0{} Y: 0.02 Z: 0.03 dps"), IsEmpty());
}

}  // namespace
}  // namespace thermorig::test::doubtful_layouts

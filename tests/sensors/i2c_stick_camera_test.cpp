// SPDX-License-Identifier: MIT
// Lines of a Melexis I2C-Stick with an MLX90640's own words, which the simulated sensor makes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "simulation/raw_mlx90640.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "wire/scan.h"

namespace thermorig::test::i2c_stick {
namespace {

using simulation::RawMlx90640;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const RawMlx90640 sensor(1);

template <std::size_t Size>
std::string hex(const std::array<std::uint16_t, Size>& words) {
  std::string text;
  for (const std::uint16_t word : words) text += fmt::format("{:04X},", word);
  text.pop_back();
  return text;
}

std::string eeprom_line(const RawMlx90640::Eeprom& eeprom = sensor.eeprom()) {
  return "mr:33:2400,10,01,0340,DATA," + hex(eeprom) + "\r\n";
}

RawMlx90640::HalfFrame words_of(float temp_c, unsigned subpage) {
  std::array<float, frame_pixels> all_c{};
  all_c.fill(temp_c);
  return sensor.half_frame(all_c, subpage, {});
}

std::string line_of(const RawMlx90640::HalfFrame& words) {
  return "raw:33:00012345:" + hex(words) + "\r\n";
}
std::string half(float temp_c, unsigned subpage) {
  return line_of(words_of(temp_c, subpage));
}

Scan<wire::CameraMessage> scan_of(const std::string& text) {
  CameraProfile profile;
  profile.protocol = "i2c-stick";
  const ByteVector bytes(text.begin(), text.end());
  return scan_any_chunking<wire::CameraMessage>(sensors::camera_scanner(profile), bytes, Stream::ends);
}

TEST(I2cStick, EachHalfFrameMakesAnImageWhoseNewHalfIsKnown) {
  const auto scan = scan_of(eeprom_line() + half(20.0F, 0) + half(30.0F, 1) + half(40.0F, 0));
  ASSERT_EQ(scan.messages.size(), 2U) << "one half alone is no image";
  EXPECT_EQ(scan.messages[0].fresh.even, 0);
  EXPECT_EQ(scan.messages[0].fresh.odd, 384);
  EXPECT_EQ(scan.messages[1].fresh.even, 384);
  EXPECT_EQ(scan.messages[1].fresh.odd, 0);
  EXPECT_NEAR(scan.messages[0].frame.temp_c[0], 20.0F, 0.08F);
  EXPECT_NEAR(scan.messages[0].frame.temp_c[1], 30.0F, 0.08F);
  EXPECT_NEAR(scan.messages[1].frame.temp_c[0], 40.0F, 0.08F);
  EXPECT_NEAR(scan.messages[1].frame.temp_c[1], 30.0F, 0.08F);
  EXPECT_NEAR(scan.messages[1].frame.sensor_temp_c, 35.0F, 0.02F);
  EXPECT_EQ(scan.counters.replies, 2U) << "the EEPROM, and the half before there was an image";
  EXPECT_EQ(scan.counters.bytes_in_damaged, 0U);
}

/// The stick prints it when it is asked, up to a period before the sensor has measured.
TEST(I2cStick, WhatIsPrintedBeforeTheExposureEndsIsNoPartOfTheMessage) {
  const std::string before = eeprom_line() + half(20.0F, 0);
  const auto scan = scan_of(before + half(30.0F, 1));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.messages[0].span.begin, before.size() + std::string("raw:33:").size());
}

TEST(I2cStick, AHalfFrameThatCameTwiceIsAnImageWithNothingNew) {
  const auto scan = scan_of(eeprom_line() + half(20.0F, 0) + half(30.0F, 1) + half(30.0F, 1));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_TRUE(scan.messages[1].fresh.none_fresh());
}

TEST(I2cStick, HalfFramesBeforeTheEepromAreRefusedAndCounted) {
  const auto scan =
      scan_of(half(20.0F, 0) + half(30.0F, 1) + eeprom_line() + half(20.0F, 0) + half(30.0F, 1));
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_value, 2U);
}

TEST(I2cStick, TornInterleavedAndUnmeasuredHalfFramesAreRefusedAndCounted) {
  auto torn = words_of(20.0F, 0);
  torn[833] |= 8U;
  auto interleaved = words_of(20.0F, 0);
  interleaved[832] &= static_cast<std::uint16_t>(~0x1000U);
  auto unread = words_of(20.0F, 0);
  unread[64] = 0x7FFF;
  auto cold = words_of(20.0F, 0);
  cold[64] = 0x8000;
  const std::string begin = eeprom_line() + half(20.0F, 0) + half(30.0F, 1);
  for (const std::string& line : {line_of(torn), line_of(interleaved), line_of(unread), line_of(cold),
                                  std::string("raw:33:00012345:FAIL: new_data bit set during read\r\n")}) {
    SCOPED_TRACE(line.substr(0, 40));
    const auto scan = scan_of(begin + line + half(22.0F, 0));
    ASSERT_EQ(scan.messages.size(), 2U);
    EXPECT_TRUE(scan.messages[1].resync_before);
    EXPECT_EQ(scan.counters.bad_value, 1U);
    EXPECT_EQ(scan.counters.bytes_in_damaged, line.size());
  }
}

TEST(I2cStick, LostBytesCostTheirLineAndMoveNoWord) {
  const std::string begin = eeprom_line() + half(20.0F, 0) + half(30.0F, 1), end = half(22.0F, 0);
  const std::string middle = half(32.0F, 1);
  for (std::size_t at = 0; at < middle.size(); at += 449) {
    for (const std::size_t lost : {1U, 5U, 2000U}) {
      std::string damaged = middle;
      damaged.erase(at, lost);
      const auto scan = scan_of(begin + damaged + end);
      ASSERT_GE(scan.messages.size(), 1U);
      for (const wire::CameraMessage& message : scan.messages) {
        EXPECT_TRUE(std::abs(message.frame.temp_c[0] - 21.0F) < 1.1F) << at;
        EXPECT_NEAR(message.frame.temp_c[1], 30.0F, 0.08F) << at;
      }
    }
  }
}

TEST(I2cStick, OtherLinesAreNoSignOfTrouble) {
  const std::string banner = "melexis-i2c-stick booted: '?' for help\r\n!:interactive mode\r\n";
  const std::string answers = "+ch:I2C_FREQ=OK\r\n+cs:33:RR=OK [mlx-register]\r\n";
  const auto scan = scan_of(banner + eeprom_line() + answers + half(20.0F, 0) + answers + half(30.0F, 1));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_FALSE(scan.messages[0].resync_before);
  EXPECT_EQ(scan.counters.resyncs, 0U);
}

TEST(I2cStick, PixelsThatTheEepromMarksShowThoseOfTheirHalfAroundThem) {
  auto eeprom = sensor.eeprom();
  eeprom[0x40 + 100] = 0;
  auto words = words_of(20.0F, 1);
  words[100] = 0x8000;  // row 3, column 4: odd
  const auto scan = scan_of(eeprom_line(eeprom) + half(30.0F, 0) + line_of(words));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_NEAR(scan.messages[0].frame.temp_c[100], 20.0F, 0.08F);
}

TEST(I2cStick, IsRecognisedAndAnEepromThatCannotBeIsNamed) {
  const auto recognised = [](const std::string& text) {
    return sensors::recognise(ByteVector(text.begin(), text.end()), 2.0);
  };
  auto found = recognised(eeprom_line() + half(20.0F, 0) + half(30.0F, 1));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].protocol, "i2c-stick");
  EXPECT_TRUE(found[0].is_usable());
  found = recognised(half(20.0F, 0) + half(30.0F, 1));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].evidence.text, HasSubstr("2 raw half-frame(s)"));
  EXPECT_THAT(found[0].evidence.text, HasSubstr("without the sensor's EEPROM"));
  auto eeprom = sensor.eeprom();
  eeprom.fill(0xFFFF);
  found = recognised(eeprom_line(eeprom) + half(20.0F, 0));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].is_usable());
  EXPECT_THAT(found[0].evidence.advice, HasSubstr("FFFF"));
}

TEST(I2cStick, ItsOwnImagesAreRecognisedAsTheSticks) {
  std::string line = "@33:02:mv:33:00012345:27.41";
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) line += ",23.10";
  line += "\r\n";
  const std::string text = line + line;
  const auto found = sensors::recognise(ByteVector(text.begin(), text.end()), 2.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].protocol, "i2c-stick");
  EXPECT_TRUE(found[0].evidence.is_asked_otherwise);
}

/// It has no end mark. A recording asks for the other format.
TEST(I2cStick, ItsFormatBinIsNamedAndNotRead) {
  const std::string text = "raw:33:00012345:BIN:1:1668\r\n" + std::string(1668, '\x01');
  const auto found = sensors::recognise(ByteVector(text.begin(), text.end()), 2.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].evidence.text, HasSubstr("in its format BIN, which is not read"));
  EXPECT_TRUE(found[0].evidence.is_asked_otherwise);
}

}  // namespace
}  // namespace thermorig::test::i2c_stick

// SPDX-License-Identifier: MIT
#include "thermorig/sensors/text_format.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/captures.h"
#include "support/gyro_scanners.h"
#include "wire/scan.h"

namespace thermorig::test::text_format {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::optional<sensors::TextFormat> guess(const std::string& text, double heard_s = 0.0) {
  const ByteVector bytes(text.begin(), text.end());
  return sensors::guess_text_format(bytes, sensors::StreamStart::anywhere, heard_s);
}

/// Twenty lines by number, behind the tail of one.
std::string lines(const std::function<std::string(int)>& line) {
  std::string text = "5,1\r\n";
  for (int i = 0; i < 20; ++i) text += line(i) + "\r\n";
  return text;
}

TEST(TextFormat, OfI2cdevlibHasItsPrefixAndTheRatesBehindTheAccelerations) {
  const auto format =
      guess(lines([](int i) { return fmt::format("a/g:\t-124\t88\t16012\t-33\t{}\t7", i % 3); }));
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.prefix, "a/g:");
  EXPECT_THAT(format->columns.rate, ElementsAre(3, 4, 5));
  EXPECT_DOUBLE_EQ(format->columns.scale_dps, 1.0 / 131.0);
  EXPECT_EQ(format->columns.time, -1);
  EXPECT_EQ(format->fields, 6U);
  EXPECT_EQ(format->lines, 20U);
  EXPECT_EQ(format->sample_line, "a/g:\t-124\t88\t16012\t-33\t0\t7");
}

TEST(TextFormat, TakesAFirstColumnThatRunsForTheClockInTheUnitOfTheLineRate) {
  struct Clock {
    double step, unit_s;
  };
  for (const Clock& clock : {Clock{5, 1e-3}, Clock{5000, 1e-6}, Clock{0.005, 1.0}}) {
    const auto text = lines([&](int i) { return fmt::format("{},{},-0.5,3", 100 + i * clock.step, i % 2); });
    for (const double heard_s : {0.1, 0.0}) {
      const auto format = guess(text, heard_s);
      ASSERT_TRUE(format.has_value());
      EXPECT_EQ(format->columns.time, 0);
      EXPECT_EQ(format->columns.time_unit_s, clock.unit_s);
      EXPECT_THAT(format->columns.rate, ElementsAre(1, 2, 3));
      EXPECT_EQ(format->columns.prefix, "");
    }
  }
}

TEST(TextFormat, TakesASlowGyrosMillisecondsForWhatTheyAre) {
  const auto format = guess(lines([](int i) { return fmt::format("{},1,2,3", 1000 * i); }), 20.0);
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.time_unit_s, 1e-3);
}

TEST(TextFormat, TakesNoRateForTheClock) {
  const auto format = guess(lines([](int i) { return fmt::format("{},1,2,3", i % 7); }));
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.time, -1);
  EXPECT_THAT(format->columns.rate, ElementsAre(1, 2, 3));
  EXPECT_THAT(format->assumptions,
              Contains(HasSubstr("columns 1,2,3 are taken as the rates, which is a guess")));
  EXPECT_FALSE(format->is_known());
}

TEST(TextFormat, GoesByTheNamesThatColumnsCarry) {
  const auto named = guess(lines([](int i) { return fmt::format("gx:{} gy:2 gz:3 ax:4 ay:5 az:6", i % 3); }));
  ASSERT_TRUE(named.has_value());
  EXPECT_THAT(named->columns.rate, ElementsAre(0, 1, 2));
  EXPECT_EQ(named->columns.prefix, "");
}

TEST(TextFormat, GoesByAHeaderLine) {
  const auto format =
      guess("tail\nGyroZ_rad/s;GyroY;GyroX_rad/s;acc_x_g;t_us\n1;2;3;0;10\n3;2;1;0;20\n1;2;3;0;30\n");
  ASSERT_TRUE(format.has_value());
  EXPECT_THAT(format->columns.rate, ElementsAre(2, 1, 0));
  EXPECT_NEAR(format->columns.scale_dps, 57.29578, 1e-5);
  EXPECT_EQ(format->columns.time, 4);
  EXPECT_EQ(format->columns.time_unit_s, 1e-6);
}

TEST(TextFormat, ReadsWordsBetweenNumbers) {
  const auto format =
      guess(lines([](int i) { return fmt::format("Rotation X: {}.5, Y: -2, Z: 3 rad/s", i % 3); }));
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.prefix, "Rotation X:");
  EXPECT_THAT(format->columns.rate, ElementsAre(0, 2, 4));
}

TEST(TextFormat, PrefersTheLinesThatAreMarkedAsRates) {
  const auto format =
      guess(lines([](int i) { return fmt::format("{},1,2,{}", i % 2 == 0 ? "A" : "G", i % 3); }));
  ASSERT_TRUE(format.has_value());
  EXPECT_EQ(format->columns.prefix, "G,");
  EXPECT_EQ(format->lines, 10U);
}

TEST(TextFormat, IsNoneWithoutLinesOfNumbers) {
  EXPECT_FALSE(guess("").has_value());
  EXPECT_FALSE(guess("hello\nworld\nnothing here 1 2\nand more\n").has_value());
  EXPECT_FALSE(guess("1,2,3\n4,5,6\n7,8").has_value());  // one whole line
  const ByteVector noise = random_bytes(20000, 5);
  EXPECT_FALSE(sensors::guess_text_format(noise).has_value());
}

TEST(TextFormat, ShowsTheFirstLineWhateverItHolds) {
  const std::string text = "\r\n\x01\x02\r\nready, 3 axes\r\n1,2,3\r\n";
  const auto line = sensors::first_text_line(ByteVector(text.begin(), text.end()));
  ASSERT_TRUE(line.has_value());
  EXPECT_EQ(line->text, "ready, 3 axes");
  EXPECT_EQ(line->fields, 3U);
  EXPECT_FALSE(sensors::first_text_line(random_bytes(100, 1)).has_value());
}

TEST(TextFormat, ReadsTheLinesItWasGuessedFrom) {
  const std::string text = lines([](int i) { return fmt::format("G,{},1.5,{},-3", 10 * i, i % 4); });
  const ByteVector bytes(text.begin(), text.end());
  const auto format = guess(text);
  ASSERT_TRUE(format.has_value());
  const auto scan = scan_any_chunking<wire::GyroMessage>(text_scanner(format->columns), bytes);
  EXPECT_EQ(scan.messages.size(), 20U);
  EXPECT_EQ(scan.messages.back().reading.device_time_us, 190'000);
  EXPECT_EQ(scan.messages.back().reading.rate_dps, (std::array<float, 3>{1.5F, 3.0F, -3.0F}));
}

TEST(TextFormat, OfARealLogIsInItsHeader) {
  const auto bytes = read_capture("mpu6050_usb_serial/set-1_rotate-360ccw-around-z-pointing-up_gyro.csv");
  if (!bytes) GTEST_SKIP() << "no captures in " << captures_folder();
  const auto format = sensors::guess_text_format(*bytes, sensors::StreamStart::at_line_start);
  ASSERT_TRUE(format.has_value());
  EXPECT_THAT(format->columns.rate, ElementsAre(1, 2, 3));
  EXPECT_EQ(format->columns.time, 0);
  EXPECT_EQ(format->columns.time_unit_s, 1.0);
}

}  // namespace
}  // namespace thermorig::test::text_format

// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "support/captures.h"
#include "support/gyro_scanners.h"
#include "wire/scan.h"

namespace thermorig::test {
namespace {

using wire::GyroMessage;

ByteVector bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

Scan<GyroMessage> scan_text(const std::string& text, const TextColumns& columns = {}) {
  return scan_any_chunking<GyroMessage>(text_scanner(columns), bytes_of(text), Stream::ends);
}

/// A stream that is known to begin with a line.
Scan<GyroMessage> scan_file(const std::string& text, const TextColumns& columns = {}) {
  return scan_any_chunking<GyroMessage>(text_scanner(columns, sensors::StreamStart::at_line_start),
                                        bytes_of(text), Stream::ends);
}

/// The columns of i2cdevlib's "a/g:" lines: acceleration first, then rates in counts of 1/131 deg/s.
TextColumns i2cdevlib_columns() {
  TextColumns columns;
  columns.prefix = "a/g:";
  columns.rate = {3, 4, 5};
  columns.scale_dps = 1.0 / 131.0;
  return columns;
}

TEST(TextGyroScanner, ReadsRawCountsOfI2cdevlib) {
  const auto scan = scan_text("a/g:\t-104\t52\t16500\t131\t-262\t32767\r\n", i2cdevlib_columns());
  ASSERT_EQ(scan.messages.size(), 1U);
  const GyroReading& reading = scan.messages[0].reading;
  EXPECT_FLOAT_EQ(reading.rate_dps[0], 1.0F);
  EXPECT_FLOAT_EQ(reading.rate_dps[1], -2.0F);
  EXPECT_EQ(reading.counts, (std::array<std::int16_t, 3>{131, -262, 32767}));
  EXPECT_TRUE(reading.saturated);
  EXPECT_FALSE(reading.temp_c.has_value());
}

TEST(TextGyroScanner, IgnoresBannersWithoutCallingThemALoss) {
  const std::string banner = "MPU6050 connection successful\r\n\r\n";
  const std::string sample = "a/g:\t1\t2\t3\t4\t5\t6\r\n";
  const auto scan = scan_text(banner + sample + banner + sample, i2cdevlib_columns());
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_FALSE(scan.messages[1].lost_before);
  EXPECT_EQ(scan.counters.bytes_skipped, 2 * banner.size());
  EXPECT_EQ(scan.counters.bad_value, 0U);
  EXPECT_EQ(scan.counters.resyncs, 0U);
}

TEST(TextGyroScanner, SpansALineWithItsLineEnd) {
  const auto scan = scan_text("x\n1,2,3\r\n4,5,6\n");
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.messages[0].span, (StreamSpan{2, 9}));
  EXPECT_EQ(scan.messages[1].span, (StreamSpan{9, 15}));
}

TEST(TextGyroScanner, ReadsDeviceTimeInItsUnit) {
  TextColumns columns;
  columns.rate = {1, 2, 3};
  columns.time = 0;
  const auto milliseconds = scan_text("x\n12.5,1,2,3\n", columns);
  ASSERT_EQ(milliseconds.messages.size(), 1U);
  EXPECT_EQ(milliseconds.messages[0].reading.device_time_us, 12500);
  columns.time_unit_s = 1.0;
  const auto seconds = scan_text("x\n-0.25,1,2,3\n", columns);
  ASSERT_EQ(seconds.messages.size(), 1U);
  EXPECT_EQ(seconds.messages[0].reading.device_time_us, -250000);
}

TEST(TextGyroScanner, CountsALineWhoseDeviceTimeCannotBe) {
  TextColumns columns;
  columns.rate = {1, 2, 3};
  columns.time = 0;
  const auto scan = scan_text("x\n1e300,1,2,3\nnan,1,2,3\n,1,2,3\n5,1,2,3\n", columns);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_value, 3U);
}

TEST(TextGyroScanner, CountsAValueThatIsNoRateOnceItIsScaled) {
  TextColumns columns;
  columns.scale_dps = 1e30;
  const auto scan = scan_text("x\n1e30,0,0\n1,0,0\n", columns);
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_value, 1U);
  EXPECT_TRUE(scan.messages[0].lost_before);
}

TEST(TextGyroScanner, KeepsCountsOnlyWhereAllOfThemAreWholeNumbersOf16Bits) {
  const auto scan = scan_text("x\n1,2,3.5\n1,2,40000\n-32768,0,0\n");
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.messages[0].reading.counts, (std::array<std::int16_t, 3>{0, 0, 0}));
  EXPECT_EQ(scan.messages[1].reading.counts, (std::array<std::int16_t, 3>{0, 0, 0}));
  EXPECT_FALSE(scan.messages[1].reading.saturated);
  EXPECT_EQ(scan.messages[2].reading.counts[0], -32768);
  EXPECT_TRUE(scan.messages[2].reading.saturated);
}

TEST(TextGyroScanner, RejectsALineThatSwallowedItsNeighbour) {
  const auto scan = scan_text("x\n1,2,3\n4,5,67,8,9\n10,11,12\n13,14,15\n");
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.messages[1].reading.rate_dps[0], 10.0F);
  EXPECT_TRUE(scan.messages[1].lost_before);
  EXPECT_EQ(scan.counters.bad_value, 1U);
}

TEST(TextGyroScanner, FollowsADeviceThatChangesItsNumberOfColumns) {
  const auto scan = scan_text("x\n1,2,3\n1,2,3\n1,2,3,25\n1,2,3,25\n1,2,3,25\n");
  EXPECT_EQ(scan.messages.size(), 4U);
  EXPECT_EQ(scan.counters.bad_value, 1U);
  EXPECT_EQ(scan.counters.layout_changes, 1U) << "which is told: the columns may mean something else";
  EXPECT_EQ(scan_text("x\n1,2,3\n4,5,67,8,9\n1,2,3\n1,2,3\n").counters.layout_changes, 0U);
}

TEST(TextGyroScanner, DoesNotTrustAFirstLineThatMayBeATail) {
  EXPECT_EQ(scan_text("2.5,1,2\n-12.5,1,2\n").messages.size(), 1U);
  EXPECT_EQ(scan_text("a/g:1 2 3 4 5 6\n", i2cdevlib_columns()).messages.size(), 1U);
}

TEST(TextGyroScanner, ReadsEveryLineOfAStreamThatBeginsWithOne) {
  const auto scan = scan_file("1,2,3\n4,5,6\n7,8,9\n");
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.messages[0].reading.rate_dps[0], 1.0F);
  EXPECT_FALSE(scan.messages[0].lost_before);
  EXPECT_EQ(scan.counters.resyncs, 0U);
  EXPECT_EQ(scan_file("1,2,3\n").messages.size(), 1U);
}

TEST(TextGyroScanner, DeliversTheFirstSampleOnceASecondOneAgrees) {
  sensors::GyroScanner scanner = text_scanner({}, sensors::StreamStart::at_line_start);
  std::vector<GyroMessage> messages;
  scanner.push(bytes_of("1,2,3\n4,5"), messages);
  EXPECT_TRUE(messages.empty());
  scanner.push(bytes_of(",6\n"), messages);
  EXPECT_EQ(messages.size(), 2U);
  scanner.push(bytes_of("7,8,9\n"), messages);
  EXPECT_EQ(messages.size(), 3U);
}

TEST(TextGyroScanner, TakesABannerOfNumbersForNoSample) {
  const auto scan = scan_file("-76 -2359 1688 0 0 0\n1 2 3\n4 5 6\n7 8 9\n");
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_FALSE(scan.messages[0].lost_before);
  EXPECT_EQ(scan.counters.bad_value, 0U);
  EXPECT_EQ(scan.counters.bytes_skipped, 21U);
}

TEST(TextGyroScanner, KeepsTheFirstSampleWhenTheSecondIsDamaged) {
  const auto scan = scan_file("1,2,3\n4,5,67,8,9\n10,11,12\n13,14,15\n");
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_EQ(scan.messages[0].reading.rate_dps[0], 1.0F);
  EXPECT_EQ(scan.counters.bad_value, 1U);
}

TEST(TextGyroScanner, WaitsNoLongerThanAFewLinesForTwoThatAgree) {
  std::string text;
  for (int line = 0; line < 300; ++line) text += line % 2 == 0 ? "1,2,3\n" : "1,2,3,4\n";
  const auto scan = scan_file(text);
  EXPECT_EQ(scan.messages.size(), 150U);
  EXPECT_EQ(scan.counters.bad_value, 150U);
}

TEST(TextGyroScanner, TakesTheValueOfAColumnThatCarriesItsName) {
  for (const char* text : {"gx:1.5,gy:-2.0,gz:3.0\n", "gx=1.5 gy=-2.0 gz=3.0\n", "x:1.5\ty:-2\tz:3\n"}) {
    const auto scan = scan_file(text);
    ASSERT_EQ(scan.messages.size(), 1U) << text;
    EXPECT_EQ(scan.messages[0].reading.rate_dps, (std::array<float, 3>{1.5F, -2.0F, 3.0F}));
  }
  EXPECT_EQ(scan_file("12:30,1,2\n12:31,1,2\n").counters.bad_value, 2U);  // a time of day is no name
  EXPECT_EQ(scan_file("a/g:\t1\t2\t3\n").counters.bad_value, 1U);         // nor does a blank end one
}

TEST(TextGyroScanner, EndsALineAtCrLfOrBoth) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text;
    for (const char* line : {"1,2,3", "4,5,6", "7,8,9"}) text += line + end;
    const auto scan = scan_file(text);
    ASSERT_EQ(scan.messages.size(), 3U) << bytes_of(end).size();
    EXPECT_EQ(scan.counters.bytes_in_messages, text.size());
    EXPECT_EQ(scan.messages[1].span, (StreamSpan{5 + end.size(), 2 * (5 + end.size())}));
  }
  const auto joined = scan_text("2.5,1,2\r-12.5,1,2\r3,1,2\r");
  ASSERT_EQ(joined.messages.size(), 2U);
  EXPECT_EQ(joined.messages[0].reading.rate_dps[0], -12.5F);
}

TEST(TextGyroScanner, LeavesALastLineWithoutAnEndPending) {
  const auto scan = scan_file("1,2,3\n4,5,6\n7,8,9");
  EXPECT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.counters.bytes_pending, 5U);
}

TEST(TextGyroScanner, HoldsNoMoreThanOneLine) {
  const auto scan = scan_text("x\n" + std::string(100000, '7') + "\n1,2,3\n");
  EXPECT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.counters.bad_length, 1U);
  EXPECT_EQ(scan.counters.resyncs, 1U);

  const auto endless = scan_text(std::string(30000, 'a'), i2cdevlib_columns());
  EXPECT_EQ(endless.counters.bytes_pending, 0U);
  EXPECT_EQ(endless.counters.bytes_skipped, 30000U);
}

TEST(TextGyroScanner, TakesALineOfExactlyTheLongestLength) {
  const std::string sample = "1,2,3";
  const std::string padding(4096 - sample.size(), ' ');
  EXPECT_EQ(scan_text("x\n" + sample + padding + "\n").messages.size(), 1U);
  EXPECT_EQ(scan_text("x\n" + sample + padding + " \n").counters.bad_length, 1U);
}

TEST(TextGyroScanner, SurvivesBinaryNoise) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ByteVector bytes = random_bytes(20000, seed);
    append(bytes, bytes_of("\n1,2,3\n1,2,3\n"));
    const auto scan = scan_any_chunking<GyroMessage>(text_scanner({}), bytes);
    EXPECT_GE(scan.messages.size(), 1U);
    EXPECT_LE(scan.messages.size(), 2U);
  }
}

TEST(TextGyroScanner, ReadsARealLogOfAnMpu6050) {
  const auto bytes = read_capture("mpu6050_usb_serial/set-1_rotate-360ccw-around-z-pointing-up_gyro.csv");
  if (!bytes) GTEST_SKIP() << "no captures in " << captures_folder();
  TextColumns columns;
  columns.rate = {1, 2, 3};
  columns.time = 0;
  columns.time_unit_s = 1.0;
  const auto scan = scan_any_chunking<GyroMessage>(text_scanner(columns), *bytes);
  const auto lines = static_cast<std::size_t>(std::count(bytes->begin(), bytes->end(), '\n'));
  EXPECT_EQ(scan.messages.size(), lines - 1);  // the first line names the columns
  EXPECT_EQ(scan.counters.bad_value, 0U);
}

TEST(TextGyroScanner, CountsLinesOfOtherKindsAsFillerAndNotAsDamage) {
  TextColumns columns;
  columns.prefix = "Rotation X:";
  columns.rate = {0, 2, 4};
  std::string text;
  for (int i = 0; i < 10; ++i)
    text += fmt::format(
        "Acceleration X: 0.1{0}, Y: 0.2, Z: 9.8 m/s^2\r\nRotation X: 0.0{0}, Y: 0.01, Z: 0.02 rad/s\r\n", i);
  const auto scan = scan_any_chunking<wire::GyroMessage>(text_scanner(columns),
                                                         ByteVector(text.begin(), text.end()), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 10U);
  EXPECT_EQ(scan.counters.bytes_in_filler,
            10 * (sizeof("Acceleration X: 0.10, Y: 0.2, Z: 9.8 m/s^2\r\n") - 1));
  EXPECT_EQ(scan.counters.bytes_in_filler, scan.counters.bytes_skipped);
  EXPECT_EQ(scan.counters.bytes_in_damaged, 0U);
}

}  // namespace
}  // namespace thermorig::test

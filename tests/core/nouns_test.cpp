// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/printable.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::test {

namespace {

TEST(Time, RoundsSecondsToTheNearestNanosecond) {
  EXPECT_EQ(from_s(1.2345678904e0).count(), 1234567890);
  EXPECT_EQ(from_s(-0.0000000006).count(), -1);
  EXPECT_EQ(from_s(0.0000000004).count(), 0);
  EXPECT_DOUBLE_EQ(to_s(from_s(-12.5)), -12.5);
  EXPECT_DOUBLE_EQ(to_s(from_s(1e300)), 4e9);
  EXPECT_DOUBLE_EQ(to_s(from_s(-std::numeric_limits<double>::infinity())), -4e9);
  EXPECT_EQ(from_s(std::numeric_limits<double>::quiet_NaN()).count(), 0);
}

TEST(Frame, SubpagesAreAChessboard) {
  int odd = 0;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column) {
      EXPECT_EQ(subpage_of(row, column), (row + column) % 2);
      odd += static_cast<int>(subpage_of(row, column));
    }
  EXPECT_EQ(odd, static_cast<int>(frame_pixels) / 2);
}

TEST(RigProfile, FindsTheLinkOfEachDevice) {
  RigProfile profile;
  for (const Device device : all_devices) profile.link(device).port = std::string(name_of(device));
  EXPECT_EQ(profile.camera.link.port, "camera");
  EXPECT_EQ(profile.gyro.link.port, "gyro");
  EXPECT_EQ(profile.servo.link.port, "servo");
}

TEST(PerDevice, KeepsOneValueForEach) {
  PerDevice<int> numbers;
  for (const Device device : all_devices) numbers[device] = static_cast<int>(index_of(device)) + 1;
  EXPECT_EQ(numbers[Device::camera], 1);
  EXPECT_EQ(numbers[Device::servo], 3);
}

TEST(LabelledSample, NamesTheLowestReasonFirst) {
  LabelledSample sample;
  EXPECT_EQ(sample.first_reason(), 0);
  sample.reason_bits = 0b1010;
  EXPECT_EQ(sample.first_reason(), 2);
  sample.reason_bits = 1U << 31;
  EXPECT_EQ(sample.first_reason(), 32);
}

TEST(Error, SaysWhatWhereAndWhatToTry) {
  const Error error(ExitCode::device_missing, "nothing was heard", "/dev/ttyUSB0", "check the cable");
  EXPECT_STREQ(error.what(), "/dev/ttyUSB0: nothing was heard\n  try: check the cable");
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_EQ(error.what_happened(), "nothing was heard");
  EXPECT_EQ(error.where(), "/dev/ttyUSB0");
  EXPECT_EQ(error.advice(), "check the cable");
}

TEST(Error, LeavesOutWhatIsNotKnown) {
  EXPECT_STREQ(Error(ExitCode::failed, "it broke", "", "").what(), "it broke");
}

using testing::ElementsAre;
using testing::IsEmpty;

TEST(RawStream, GivesBackTheChunksThatWereAppended) {
  RawStream stream;
  stream.append(std::vector<std::uint8_t>{1, 2, 3}, host_time_ns(10));
  stream.append(std::vector<std::uint8_t>{}, host_time_ns(20));
  stream.append(std::vector<std::uint8_t>{4}, host_time_ns(30));
  ASSERT_EQ(stream.chunk_count(), 3U);
  EXPECT_THAT(stream.chunk(0), ElementsAre(1, 2, 3));
  EXPECT_THAT(stream.chunk(1), IsEmpty());
  EXPECT_THAT(stream.chunk(2), ElementsAre(4));
  EXPECT_EQ(stream.time(2), host_time_ns(30));
}

using namespace std::string_literals;

TEST(Printable, LeavesTextOfAnyScriptAsItIs) {
  for (const char* text : {"", "garden_acq-01.h5", "C:\\n", "Gerät", "温度", "שלום", "🌡", "a\u00A0b"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, NamesWhatWouldSteerATerminal) {
  EXPECT_EQ(printable("a\nb\x1b[2J"), "a\\nb\\u{1B}[2J");
  EXPECT_EQ(printable("\ta\r\0\x7f"s), "\\ta\\r\\u{00}\\u{7F}"s);
  EXPECT_EQ(printable("\u009B31m"), "\\u{9B}31m");
}

TEST(Printable, NamesWhatTurnsTheDirectionOrCannotBeSeen) {
  EXPECT_EQ(printable("CC-BY\u202E4.0"), "CC-BY\\u{202E}4.0");
  EXPECT_EQ(printable("a\u061C\u180E\u00ADb"), "a\\u{61C}\\u{180E}\\u{AD}b");
}

TEST(Printable, NamesBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\xFF"), "\\xFF");
  EXPECT_EQ(printable("a\xC3"), "a\\xC3");                           // cut short
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF");                    // longer than it need be
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80");           // half a pair of UTF-16
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond the last character
  EXPECT_EQ(printable("\x9B"
                      "31m"),
            "\\x9B31m");
}

TEST(Printable, TwiceGivesTheSameAsOnce) {
  const std::string once = printable("a\n\xFF\u202E");
  EXPECT_EQ(printable(once), once);
}

TEST(Shell, ReadsAWordOfAPrintedCommandAsItWasMeant) {
  for (const char* plain :
       {"recordings/garden/garden_acq-01_20261130T015933Z.h5", "../a-b@c.h5", "/dev/ttyUSB0"})
    EXPECT_EQ(shell_word(plain), plain);
  EXPECT_EQ(shell_word("my data/x.h5"), "'my data/x.h5'");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  for (const char* steering : {"a;b", "$HOME", "a*b", "`ls`", "~", "a|b", "a&b", "(a)", "a\nb", ""})
    EXPECT_EQ(shell_word(steering), "'" + std::string(steering) + "'");
}

}  // namespace

}  // namespace thermorig::test

// SPDX-License-Identifier: MIT
// Streams that are sound and that no protocol reads: each is named, with what to do about it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/vectors.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "wire/scan.h"

namespace thermorig::test::foreign_bytes {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ByteVector bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string csv(int lines) {
  std::string text;
  for (int i = 0; i < lines; ++i) text += fmt::format("{},0.{},-0.42,0.{}\r\n", 1000 + i, i % 10, i % 7);
  return text;
}

std::string utf16(const std::string& text, bool big_endian) {
  std::string out = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) out += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

std::string hex(const char* format, const char* end, bool offset) {
  std::string text;
  for (std::int16_t i = 0; i < 40; ++i) {
    const auto packet = wire::witmotion_gyro_packet({i, -2, 300}, 26.0F);
    if (offset) text += fmt::format("{:08x}: ", 11 * i);
    for (const std::uint8_t byte : packet) text += fmt::format(fmt::runtime(format), byte);
    text += end;
  }
  return text;
}

std::string image(const char* between, int columns, int rows) {
  std::string text = "MLX90640 IR Array Example\r\nMLX90640 online!\r\n";
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < columns; ++i) text += fmt::format("{:.2f}{}", 22.0 + 0.01 * i, between);
    text += "\r\n";
  }
  return text;
}

std::string repeated(const std::string& frame, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += frame;
  return text;
}

/// `count` frames of `size` bytes that begin with `mark`; the others change.
std::string marked(const std::string& mark, std::size_t size, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const ByteVector rest = random_bytes(size - mark.size(), static_cast<std::uint64_t>(i + 1));
    text += mark + std::string(rest.begin(), rest.end());
  }
  return text;
}

std::string rvc(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    std::string body{static_cast<char>(i)};
    body += std::string("\x10\x27\x20\x01\x05\x00\x30\x00\x40\x01\xE0\x03\0\0\0", 15);
    unsigned sum = 0;
    for (const char c : body) sum += static_cast<std::uint8_t>(c);
    text += "\xAA\xAA" + body + static_cast<char>(sum);
  }
  return text;
}

std::string comma_image() {
  std::string text;
  for (int row = 0; row < 24; ++row) {
    for (int i = 0; i < 32; ++i) text += fmt::format("21,{};", 10 + i);
    text += "\n";
  }
  return text;
}

struct Foreign {
  std::string name, bytes, text, advice;
};

const std::string teapot_packet("$\x02\x3F\x01\x02\x03\x04\x05\x06\x07\x00\x08\r\n", 14);
const std::string ble_frame(
    "\x55\x61\x0F\x00\xE7\xFF\x00\x08\x15\x00\xF4\xFF\x67\x06\x61\x00\xC2\xFF\x00\x80", 20);
const std::string modbus_answer("\x50\x03\x06\x00\x01\x00\x02\x00\x03\x0C\xE7", 11);

const std::string msp_answer(
    "$M>\x12\x66\x0A\x00\xEC\xFF\x00\x02\x10\x00\xDF\xFF\x48\x01\x00\x00\x00\x00\x00\x00\x16", 24);

const std::vector<Foreign> foreigners{
    {"UTF-16, as PowerShell writes", utf16(csv(50), false), "UTF-16", "iconv"},
    {"UTF-16, the other way round", utf16(csv(50), true), "UTF-16", "iconv"},
    {"hex bytes", hex("{:02X} ", "\n", false), "hex text", "xxd -r -p"},
    {"hex bytes with 0x", hex("0x{:02x}, ", "\n", false), "hex text", "xxd -r -p"},
    {"hex without blanks", hex("{:02x}", "\n", false), "hex text", "xxd -r -p"},
    {"a hex dump", hex("{:02x} ", " Uabc..\n", true), "hex text", "xxd -r FILE"},
    {"an MLX90641's picture", image(",", 192, 3), "form that is not read", "24 lines of 32"},
    {"rows of another length", image(", ", 40, 24), "form that is not read", "24 lines of 32"},
    {"a picture with a time that has a point", image(",", 769, 3), "769 numbers", "before a colon"},
    {"a picture with decimal commas", comma_image(), "decimal commas", "points"},
    {"hundredths of a degree", repeated(repeated("2134,2207,", 384) + "\n", 3), "whole numbers up to 2207",
     "Celsius"},
    {"a picture of letters, two a pixel in colour",
     repeated("\x1b[48;5;17m" + repeated("##..", 16) + "\x1b[0m\r\n", 48), "letters", "PRINT_TEMPERATURES"},
    {"angles of a BNO08x", rvc(30), "RVC", "more_reports"},
    {"WitMotion with wrong sums", repeated("\x55\x52\x01\x02\x03\x04\x05\x06\x07\x08\x01", 30), "wrong",
     "every byte"},
    {"a VectorNav with wrong sums", repeated("$VNIMU,+01.18,-00.24,+03.00*00\r\n", 30), "wrong",
     "every byte"},
    {"HiPNUC with wrong sums", marked(std::string("\x5A\xA5\x4C\x00", 4), 82, 30), "wrong", "every byte"},
    {"images behind another mark", marked("\x55\xAA", 1538, 5), "mark 55 AA", "binary_camera.md"},
    {"frames behind an unknown mark", marked("\xAA\x55", 16, 30), "mark AA 55", "text_gyro.md"},
    {"a Git LFS pointer", "version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 9\n", "Git LFS",
     "git lfs pull"},
    {"WitMotion over Bluetooth", "\x0F" + repeated(ble_frame, 50), "55 61", "55 52"},
    {"Modbus", repeated(modbus_answer, 30), "Modbus", "send by itself"},
    {"a picture of letters", repeated(" .-*+x%#X.-*+x%#X.-*+x%#X.-*+x%#\r\n", 48), "letters",
     "PRINT_TEMPERATURES"},
    {"ten pixels", repeated("Pixel 0: 23.45C\r\nPixel 1: 23.50C\r\n\r\n", 20), "single pixels", "Example 2"},
    {"floats without a mark", repeated(std::string("\x00\x00\xB8\x41", 4), 1600), "without a mark",
     "mark in front"},
    {"MSP", repeated(msp_answer, 30), "MSP", "MAVLink"},
    {"teapot", repeated(teapot_packet, 30), "teapot", "MPU6050_raw"},
};

TEST(ForeignBytes, AreNamedWithWhatToDo) {
  for (const Foreign& foreign : foreigners) {
    SCOPED_TRACE(foreign.name);
    const auto found = sensors::recognise(bytes_of(foreign.bytes), 1.0);
    ASSERT_FALSE(found.empty());
    EXPECT_FALSE(found[0].is_usable());
    EXPECT_THAT(found[0].evidence.text, HasSubstr(foreign.text));
    EXPECT_THAT(found[0].evidence.advice, HasSubstr(foreign.advice));
    const bool may_be_misheard = foreign.text.starts_with("mark");
    EXPECT_EQ(found[0].evidence.advice.find("baud") != std::string::npos, may_be_misheard);
    for (const auto& one : found) EXPECT_FALSE(one.is_usable()) << one.protocol;
  }
}

TEST(ForeignBytes, AreNotSeenInWhatIsRead) {
  std::string names = "t";
  std::string wide;
  for (int i = 1; i < 40; ++i)
    names += fmt::format(",{}", i < 4 ? fmt::format("g{}_dps", "xyz"[i - 1]) : "d");
  for (int row = 0; row < 20; ++row) {
    wide += fmt::format("{}", 10 * row);
    for (int i = 1; i < 40; ++i) wide += fmt::format(",{}.5", row % (i + 1));
    wide += "\n";
  }
  for (const std::string& text :
       {csv(50), names + "\n" + wide, std::string("10 20 30 40 50 60 70 80\n10 20 30 40 50 60 71 81\n")})
    EXPECT_FALSE(sensors::recognise_foreign(bytes_of(text)).has_value()) << text.substr(0, 60);
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const auto recognise : {sensors::recognise_foreign, sensors::recognise_unread})
      EXPECT_FALSE(recognise(random_bytes(20000, seed)).has_value());
  ByteVector packets;
  for (std::int16_t i = 0; i < 200; ++i)
    for (const std::uint8_t byte : wire::witmotion_gyro_packet({i, 2, 3}, 30.0F)) packets.push_back(byte);
  EXPECT_FALSE(sensors::recognise_foreign(packets).has_value());
}

std::string times(const ByteVector& bytes, int count) {
  return repeated(std::string(bytes.begin(), bytes.end()), count);
}

/// Frames of a protocol, by its vectors: good ones, replies, and some that are damaged.
TEST(ForeignBytes, AreNotSeenInFramesOfWhichSomeAreGood) {
  for (const char* file :
       {"witmotion.txt", "xsens.txt", "mip.txt", "hipnuc.txt", "mavlink_gyro.txt", "vectornav.txt"})
    for (const GoldenVector& vector : read_vectors(file))
      for (const int count : {1, 2, 5, 30}) {
        SCOPED_TRACE(fmt::format("{}, {}, {} times", file, vector.name, count));
        const ByteVector bytes = bytes_of(times(vector.bytes, count));
        for (const auto& one : sensors::recognise(bytes, 1.0)) {
          EXPECT_THAT(one.evidence.text, Not(HasSubstr("wrong")));
          const bool is_of_others = vector.name == "bluetooth_frames" || vector.name == "unknown_type";
          EXPECT_TRUE(one.role || is_of_others) << one.evidence.text;
        }
        const auto unread = sensors::recognise_unread(bytes);
        EXPECT_THAT(unread ? unread->text : "", Not(HasSubstr("wrong")));
      }
}

TEST(ForeignBytes, AreNotSeenInCameraFrames) {
  ThermalFrame warm;
  for (std::size_t i = 0; i < warm.temp_c.size(); ++i) warm.temp_c[i] = 20.0F + 0.01F * static_cast<float>(i);
  ThermalFrame even;
  even.temp_c.fill(20.0F);
  for (const ThermalFrame& frame : {ThermalFrame(), warm}) {
    const ByteVector bytes = bytes_of(times(wire::camera_frame(frame), 10));
    for (const auto recognise : {sensors::recognise_foreign, sensors::recognise_unread}) {
      const auto found = recognise(bytes);
      EXPECT_FALSE(found.has_value()) << found->text;
    }
    for (const auto& one : sensors::recognise(bytes, 1.0)) EXPECT_EQ(one.role, Device::camera);
  }
  const ByteVector part = wire::camera_frame(even);
  EXPECT_FALSE(sensors::recognise_unread(std::span(part).first(1000)).has_value());
}

std::string vectornav_lines(const char* sum_format, unsigned added) {
  std::string text;
  for (int i = 0; i < 30; ++i) {
    const std::string message = fmt::format("VNIMU,+01.18,-00.24,+03.{:02}", i);
    unsigned sum = 0;
    for (const char c : message) sum ^= static_cast<std::uint8_t>(c);
    text += "$" + message + "*" + fmt::format(fmt::runtime(sum_format), (sum ^ added) & 0xFFU) + "\r\n";
  }
  return text;
}

TEST(ForeignBytes, SayThatSumsAreWrongOnlyWhereTheyAre) {
  for (const char* format : {"{:02X}", "{:02x}"}) {
    EXPECT_FALSE(sensors::recognise_foreign(bytes_of(vectornav_lines(format, 0)))) << format;
    EXPECT_TRUE(sensors::recognise_foreign(bytes_of(vectornav_lines(format, 0x80)))) << format;
  }
  const std::string wrong("\x55\x51\x01\x02\x03\x04\x05\x06\x07\x08\x01", 11);
  const std::string right("\x55\x51\x01\x02\x03\x04\x05\x06\x07\x08\xCA", 11);
  for (const int count : {5, 6, 7})
    EXPECT_FALSE(sensors::recognise_unread(bytes_of(repeated(right, count)))) << count;
  EXPECT_FALSE(sensors::recognise_unread(bytes_of(repeated(wrong, 4))));
  EXPECT_FALSE(sensors::recognise_unread(bytes_of(repeated(wrong, 10) + right)));
  const auto some = sensors::recognise_unread(bytes_of(repeated(wrong, 20) + right + repeated(wrong, 20)));
  ASSERT_TRUE(some);
  EXPECT_THAT(some->text, HasSubstr("of which 40 have a wrong check sum"));
}

TEST(ForeignBytes, NeedManyFramesToNameAMarkAndExplainNoneOfThem) {
  EXPECT_FALSE(sensors::recognise_unread(bytes_of(marked("\xAA\x55", 8, 49))));
  EXPECT_FALSE(sensors::recognise_unread(bytes_of(marked("\xAA\x55", 40, 19))));
  const auto found = sensors::recognise_unread(bytes_of(marked("\xAA\x55", 8, 50)));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->bytes, 0U);
}

}  // namespace
}  // namespace thermorig::test::foreign_bytes

// SPDX-License-Identifier: MIT
// Streams that are sound and that no protocol reads: each is named, with what to do about it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
    EXPECT_THAT(found[0].evidence.advice, Not(HasSubstr("baud")));
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
    EXPECT_FALSE(sensors::recognise_foreign(random_bytes(20000, seed)).has_value());
  ByteVector packets;
  for (std::int16_t i = 0; i < 200; ++i)
    for (const std::uint8_t byte : wire::witmotion_gyro_packet({i, 2, 3}, 30.0F)) packets.push_back(byte);
  EXPECT_FALSE(sensors::recognise_foreign(packets).has_value());
  EXPECT_FALSE(sensors::recognise_foreign(wire::camera_frame({})).has_value());
}

}  // namespace
}  // namespace thermorig::test::foreign_bytes

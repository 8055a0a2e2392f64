// SPDX-License-Identifier: MIT
// Images that sketches send as numbers in bytes, in the layouts of public ones. All values are made up.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>

#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "wire/scan.h"

namespace thermorig::test::binary_camera {
namespace {

constexpr std::size_t frames = 6;

/// In steps of 0.1, so that every layout can say it.
double temperature(std::size_t frame, std::size_t pixel) {
  return 20.0 + 0.1 * static_cast<double>((pixel * 7 + frame) % 97);
}

void put(std::string& bytes, std::uint32_t number, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(number >> (8 * i));
}

std::string floats(std::size_t frame) {
  std::string bytes;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(temperature(frame, pixel))), 4);
  return bytes;
}

std::string words(std::size_t frame, double counts_per_kelvin) {
  std::string bytes;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    put(bytes, static_cast<std::uint32_t>(std::lround(counts_per_kelvin * temperature(frame, pixel))), 2);
  return bytes;
}

struct Layout {
  const char* name;
  std::function<std::string(std::size_t)> frame;
};

const std::vector<Layout> layouts{
    {"AA BB CC DD and floats", [](std::size_t i) { return "\xAA\xBB\xCC\xDD" + floats(i); }},
    {"AA AA and floats", [](std::size_t i) { return "\xAA\xAA" + floats(i); }},
    {"FF FF FF FF and floats", [](std::size_t i) { return "\xFF\xFF\xFF\xFF" + floats(i); }},
    {"BEGIN, three floats, pixels, END",
     [](std::size_t i) {
       std::string ahead;
       for (const float value : {29.7F, 19.9F, 24.0F}) put(ahead, std::bit_cast<std::uint32_t>(value), 4);
       return "BEGIN" + ahead + floats(i) + "END";
     }},
    {"CA 01 and tenths", [](std::size_t i) { return "\xCA\x01" + words(i, 10.0); }},
    {"00 80, type, length, hundredths",
     [](std::size_t i) { return std::string("\x00\x80\x01\x00\x00\x06", 6) + words(i, 100.0); }},
    {"S and hexadecimal tenths",
     [](std::size_t i) {
       std::string text = "S";
       for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
         text += fmt::format("{:04x}", std::lround(10.0 * temperature(i, pixel)));
       return text;
     }},
};

sensors::CameraScanner scanner() {
  CameraProfile profile;
  profile.protocol = "binary";
  return sensors::camera_scanner(profile);
}

ByteVector bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string stream_of(const Layout& layout) {
  std::string text;
  for (std::size_t frame = 0; frame < frames; ++frame) text += layout.frame(frame);
  return text;
}

/// No frame but one of those that were sent.
void expect_true_frames(const std::vector<wire::CameraMessage>& messages) {
  for (const wire::CameraMessage& message : messages) {
    const auto frame = static_cast<std::size_t>(std::lround((message.frame.temp_c[0] - 20.0F) / 0.1F));
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      ASSERT_NEAR(message.frame.temp_c[pixel], temperature(frame, pixel), 0.001) << pixel;
  }
}

TEST(BinaryCamera, ReadsTheLayoutsOfPublicSketches) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const auto scan =
        scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(stream_of(layout)), Stream::ends);
    ASSERT_EQ(scan.messages.size(), frames);
    expect_true_frames(scan.messages);
    EXPECT_EQ(scan.counters.bytes_in_messages, scan.counters.bytes_received);
    EXPECT_TRUE(std::isnan(scan.messages[0].frame.sensor_temp_c));
  }
}

TEST(BinaryCamera, FindsFramesWhereverTheStreamWasJoinedAndBehindLostBytes) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const std::string stream = stream_of(layout);
    for (std::size_t cut = 1; cut < stream.size() / 2; cut += 491) {
      const auto joined =
          scan_chunks<wire::CameraMessage>(scanner(), {ByteSpan(bytes_of(stream.substr(cut)))}, Stream::ends);
      EXPECT_GE(joined.messages.size(), 2U) << cut;
      expect_true_frames(joined.messages);
      std::string damaged = stream;
      damaged.erase(stream.size() / 3 + cut / 2, 1 + cut % 3);
      const auto lost = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(damaged), Stream::ends);
      EXPECT_GE(lost.messages.size(), frames - 3) << cut;
      expect_true_frames(lost.messages);
    }
  }
}

TEST(BinaryCamera, IsRecognised) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const auto found = sensors::recognise(bytes_of(stream_of(layout)), 2.0);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found[0].protocol, "binary");
    EXPECT_TRUE(found[0].is_usable());
  }
}

}  // namespace
}  // namespace thermorig::test::binary_camera

// SPDX-License-Identifier: MIT
// Images that sketches print as temperatures, in the layouts of public ones. All values are made up.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "wire/scan.h"

namespace thermorig::test::text_camera {
namespace {

using testing::HasSubstr;

constexpr int frames = 5;

/// A temperature that tells where it belongs.
double temperature(int frame, std::size_t pixel) {
  return 20.0 + 0.1 * static_cast<double>((pixel * 7 + static_cast<std::size_t>(frame)) % 97);
}

/// The temperatures of a frame, `columns` a line, each as `one` prints it.
std::string pixels(int frame, std::size_t columns, const std::string& between, const std::string& behind_last,
                   const std::string& line_end, const char* one = "{:.2f}") {
  std::string text;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
    text += fmt::format(fmt::runtime(one), temperature(frame, pixel));
    text += (pixel + 1) % columns == 0 ? behind_last + line_end : between;
  }
  return text;
}

struct Layout {
  const char* name;
  std::function<std::string(int)> frame;
  bool says_ambient = false;
  std::string above = "";
};

const std::vector<Layout> layouts{
    {"Adafruit simpletest",
     [](int frame) {
       return std::string(35, '=') + "\r\nAmbient temperature = 27.41 degC\r\n\r\n\r\n" +
              pixels(frame, 32, ", ", ", ", "\r\n", "{:.1f}");
     },
     true,
     "Adafruit MLX90640 Simple Test\r\nFound Adafruit MLX90640\r\nSerial number: 1A2B3C4D5E6F\r\n"
     "Current mode: Chess\r\nCurrent frame rate: 2 Hz\r\n"},
    {"Adafruit simpletest, before it printed its own temperature",
     [](int frame) {
       return std::string(35, '=') + "\r\n\r\n" + pixels(frame, 32, ", ", ", ", "\r\n", "{:.1f}");
     }},
    {"CircuitPython simpletest",
     [](int frame) {
       return "Read 2 frames in 1.03 s\n" + pixels(frame, 32, ", ", ", ", "\n", "{:.1f}") + "\n";
     },
     false, "MLX addr detected on I2C\n['0x1a2b', '0x3c4d', '0x5e6f']\n"},
    {"SparkFun Example 2", [](int frame) { return pixels(frame, 768, ",", ",", "\r\n"); }},
    {"SparkFun Example 3 with its rates",
     [](int frame) {
       return "Read rate: 3.97 Hz\r\nRead plus print rate: 1.80 Hz\r\n" +
              pixels(frame, 768, ",", ",", "\r\n");
     }},
    {"blanks between", [](int frame) { return pixels(frame, 768, " ", "", "\r\n"); }},
    {"JSON lines",
     [](int frame) { return "{\"temperature\":[" + pixels(frame, 768, ",", "", "],\"at\":24.50}\n"); }, true},
    {"JSON lines with the sensor's temperature in front",
     [](int frame) { return "{\"at\":24.50,\"data\":[" + pixels(frame, 768, ", ", "", "]}\n"); }, true},
    {"MicroPython's list", [](int frame) { return "[" + pixels(frame, 768, ", ", "]", "\n", "{:.15f}"); }},
    {"a line behind a count",
     [](int frame) { return fmt::format("{},", 1000 + 250 * frame) + pixels(frame, 768, ",", "", "\n"); }},
    {"lines with the end of a C string",
     [](int frame) { return pixels(frame, 768, ",", "", "\r\n") + std::string(1, '\0'); }},
    {"a pixel a line",
     [](int frame) {
       std::string text;
       for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
         text += fmt::format("{},{},{},{:.2f}\n", frame, pixel / 32, pixel % 32, temperature(frame, pixel));
       return text;
     },
     false, "frame,row,col,temp_C\n"},
    {"a word in front of each frame",
     [](int frame) { return "Frame: " + pixels(frame, 768, ", ", "", "\n"); }},
    {"CR alone", [](int frame) { return pixels(frame, 768, ",", "", "\r"); }},
};

sensors::CameraScanner scanner() {
  CameraProfile profile;
  profile.protocol = "text";
  return sensors::camera_scanner(profile);
}

ByteVector bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string text_of(const Layout& layout) {
  std::string text = layout.above;
  for (int frame = 0; frame < frames; ++frame) text += layout.frame(frame);
  return text;
}

TEST(TextCamera, ReadsTheLayoutsOfPublicSketches) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const auto scan =
        scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text_of(layout)), Stream::ends);
    ASSERT_EQ(scan.messages.size(), static_cast<std::size_t>(frames));
    for (int frame = 0; frame < frames; ++frame) {
      const wire::CameraMessage& message = scan.messages[static_cast<std::size_t>(frame)];
      for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
        ASSERT_NEAR(message.frame.temp_c[pixel], temperature(frame, pixel), 0.006) << pixel;
      EXPECT_EQ(std::isfinite(message.frame.sensor_temp_c), layout.says_ambient);
      EXPECT_FALSE(message.resync_before);
    }
    EXPECT_EQ(scan.counters.bytes_in_damaged, 0U);
  }
}

TEST(TextCamera, IsReadFromItsFirstBreakWhereverTheStreamWasJoined) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const std::string text = text_of(layout);
    for (std::size_t cut = layout.above.size() + 10; cut < text.size() / 2; cut += 997) {
      const auto scan =
          scan_chunks<wire::CameraMessage>(scanner(), {ByteSpan(bytes_of(text.substr(cut)))}, Stream::ends);
      ASSERT_GE(scan.messages.size(), 2U) << cut;
      for (std::size_t i = 0; i < scan.messages.size(); ++i) {
        const auto frame = static_cast<int>(frames - scan.messages.size() + i);
        ASSERT_NEAR(scan.messages[i].frame.temp_c[100], temperature(frame, 100), 0.006) << cut;
      }
    }
  }
}

TEST(TextCamera, LosesAFrameWithAMissingOrABrokenNumberAndMovesNone) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    for (const char* in_place :
         {"", "nan", "ovf", "Failed\r\n", "inf", "2 3.1", "9999.9", "1.#QNAN", "$20"}) {
      std::string text = layout.above + layout.frame(0);
      std::string damaged = layout.frame(1);
      const std::size_t at = damaged.find("2", damaged.size() / 2);
      const std::size_t end = damaged.find_first_of(", \r\n]", damaged.find('.', at));
      damaged.replace(at, end - at, in_place);
      text += damaged;
      for (int frame = 2; frame < frames; ++frame) text += layout.frame(frame);
      const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
      ASSERT_GE(scan.messages.size(), 2U) << in_place;
      for (const wire::CameraMessage& message : scan.messages) {
        const auto first = message.frame.temp_c[0];
        const int frame = static_cast<int>(std::lround((first - 20.0F) / 0.1F));
        for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
          ASSERT_NEAR(message.frame.temp_c[pixel], temperature(frame, pixel), 0.006)
              << in_place << ' ' << pixel;
      }
    }
  }
}

TEST(TextCamera, IsRecognisedAndPicturesWithoutTemperaturesAreNot) {
  for (const Layout& layout : layouts) {
    SCOPED_TRACE(layout.name);
    const auto found = sensors::recognise(bytes_of(text_of(layout)), 2.0);
    const auto camera =
        std::find_if(found.begin(), found.end(), [](const auto& one) { return one.role == Device::camera; });
    ASSERT_NE(camera, found.end());
    EXPECT_EQ(camera->protocol, "text");
  }
  std::string grey;
  for (int frame = 0; frame < 3; ++frame) grey += pixels(frame, 768, ",", "", "\n", "{:.0f}");
  const auto found = sensors::recognise(bytes_of(grey), 2.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].is_usable());
  EXPECT_THAT(found[0].evidence.text, HasSubstr("without temperatures"));
}

TEST(TextCamera, TakesRowsForAFrameBetweenMarksAlone) {
  std::string text = "begin\n";
  for (int frame = 0; frame < 6; ++frame) {
    std::string rows = pixels(frame, 32, ",", "", "\n");
    if (frame == 1) rows.erase(0, rows.find('\n') + 1);  // a row is lost, and no mark would tell
    text += rows;
  }
  const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 0U);
}

TEST(TextCamera, ReadsNoNumberOfAClockOrOfAFrameAsAPixel) {
  for (const char* front : {"12:34:51.123 -> ", "Frame 3: ", "t=12 ", "t=12.5 "}) {
    std::string text;
    for (int frame = 0; frame < 3; ++frame) text += front + pixels(frame, 768, ",", "", "\n");
    const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
    if (front == std::string("t=12.5 ")) {
      EXPECT_EQ(scan.messages.size(), 0U);  // nothing says that 12.5 is none
      continue;
    }
    ASSERT_EQ(scan.messages.size(), 3U) << front;
    EXPECT_NEAR(scan.messages[1].frame.temp_c[5], temperature(1, 5), 0.006);
  }
}

TEST(TextCamera, NamesValuesThatAreNoDegreesCelsius) {
  for (const double offset_c : {273.15, -19.99}) {
    std::string text;
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      text += fmt::format("{:.2f},", offset_c > 0 ? temperature(0, pixel) + offset_c
                                                  : 0.01 * static_cast<double>(pixel % 97));
    const auto found = sensors::recognise(bytes_of(text + "\n" + text + "\n"), 2.0);
    ASSERT_FALSE(found.empty());
    EXPECT_FALSE(found[0].is_usable());
    EXPECT_THAT(found[0].evidence.advice, HasSubstr("Celsius"));
  }
}

TEST(TextCamera, NamesFahrenheitByItsWordsAndDoubtsItByItsValues) {
  std::string text;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    text += fmt::format("{:.2f},", temperature(0, pixel) * 1.8 + 32.0);
  const auto bare = sensors::recognise(bytes_of(text + "\n" + text + "\n"), 2.0);
  ASSERT_FALSE(bare.empty());
  EXPECT_TRUE(bare[0].is_usable());
  EXPECT_THAT(bare[0].evidence.text, HasSubstr("Fahrenheit"));
  for (const char* words : {"Temp (F)\n", "{\"unit\":\"F\"}\n", "degF\n"}) {
    const auto found = sensors::recognise(bytes_of(words + text + "\n" + text + "\n"), 2.0);
    ASSERT_FALSE(found.empty());
    EXPECT_THAT(found[0].evidence.advice, HasSubstr("Fahrenheit")) << words;
  }
  for (const char* words : {"lens 55 deg FOV\n",
                            "110\xC2\xB0 FOV, 110\xC2\xB0"
                            "FOV\n",
                            "{\"f\":12}\n"}) {
    const auto found = sensors::recognise(
        bytes_of(words + pixels(0, 768, ",", "", "\n") + pixels(1, 768, ",", "", "\n")), 2.0);
    ASSERT_FALSE(found.empty()) << words;
    EXPECT_TRUE(found[0].is_usable()) << words;
    EXPECT_EQ(found[0].evidence.advice, "") << words;
  }
}

TEST(TextCamera, TakesNoBrokenFirstPixelForACount) {
  for (const char* first : {"nan", "inf", "ovf"}) {
    std::string damaged = pixels(1, 768, ",", "", "\n");
    damaged.replace(0, damaged.find(','), first);
    const std::string text = pixels(0, 768, ",", "", "\n") + damaged + pixels(2, 768, ",", "", "\n") +
                             damaged.substr(0, 4) + pixels(3, 768, ",", "", "\n");
    const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
    EXPECT_EQ(scan.messages.size(), 2U) << first;
    EXPECT_EQ(scan.counters.bad_value + scan.counters.bad_length, 2U) << first;
  }
}

TEST(TextCamera, LosesOneFrameByALineWhoseCountRanIntoItsFirstPixel) {
  std::string text;
  for (int frame = 0; frame < 6; ++frame)
    text += fmt::format("{}{}", 1 + frame, frame == 2 ? "" : ",") + pixels(frame, 768, ",", "", "\n");
  const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 5U);
  for (const wire::CameraMessage& message : scan.messages) EXPECT_LT(message.frame.temp_c[0], 32.0F);
}

TEST(TextCamera, ReadsNeitherGreyValuesWithAPointNorHalvesOfAnImage) {
  std::string grey, half;
  for (int frame = 0; frame < 3; ++frame) {
    grey += pixels(frame, 768, ",", "", "\n", "{:.0f}.0");
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      half += (pixel / 32 + pixel) % 2 == 0 ? fmt::format("{:.2f},", temperature(frame, pixel)) : "0.00,";
    half += "\n";
  }
  for (const auto& [text, reason] :
       {std::pair(grey, "without temperatures"), std::pair(half, "half-images")}) {
    const auto found = sensors::recognise(bytes_of(text), 2.0);
    ASSERT_EQ(found.size(), 1U) << reason;
    EXPECT_FALSE(found[0].is_usable());
    EXPECT_THAT(found[0].evidence.text, HasSubstr(reason));
  }
}

TEST(TextCamera, PassesOverALineThatNeverEnds) {
  std::string text = "\n";
  for (int i = 0; i < 40'000; ++i) text += "23.4,";
  text += "\n" + pixels(0, 768, ",", "", "\n");
  const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 1U);
}

TEST(TextCamera, MakesNoFrameOfRowsThatALineWithoutEndFollows) {
  std::string text = "\n" + pixels(0, 32, ",", "", "\n");
  for (int i = 0; i < 40'000; ++i) text += "23.4,";
  text += "\n\n";
  const auto scan = scan_any_chunking<wire::CameraMessage>(scanner(), bytes_of(text), Stream::ends);
  EXPECT_EQ(scan.messages.size(), 0U);
}

}  // namespace
}  // namespace thermorig::test::text_camera

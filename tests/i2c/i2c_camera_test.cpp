// SPDX-License-Identifier: MIT
// A camera on a bus in memory, in virtual time: which bytes it makes a stream of, and what they are read as.
#include "thermorig/io/i2c_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "fake_bus.h"
#include "support/captures.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"

namespace thermorig::test::i2c {
namespace {

using simulation::RawMlx90640;
using ::testing::Each;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Each measurement half a kelvin warmer than the one before.
FakeBus::Measure warming_room() {
  return [n = 0](unsigned subpage) mutable {
    std::array<float, frame_pixels> temp_c{};
    temp_c.fill(20.0F + 0.5F * static_cast<float>(n++ % 100));
    return RawMlx90640(1).half_frame(temp_c, subpage, {});
  };
}

/// A camera that takes its turns, and what came of them.
struct Ridden {
  explicit Ridden(FakeBus::Measure measure = warming_room()) : bus(std::move(measure)) {}

  void find() { camera.find(); }
  void ask(const std::string& text) {
    const std::vector<std::uint8_t> command(text.begin(), text.end());
    camera.hear(command);
  }
  /// False: it is gone.
  bool ride(double seconds) {
    const HostTime end = bus.now + from_s(seconds);
    while (bus.now < end) {
      const auto next = camera.turn();
      if (!next) return false;
      if (*next > bus.now) bus.pass(std::min(*next, end) - bus.now);
    }
    return true;
  }

  struct Came {
    wire::CameraMessage message;
    HostTime begun, read;
  };
  std::vector<Came> came() {
    CameraProfile profile;
    profile.protocol = "mlx-raw";
    sensors::CameraScanner scanner = sensors::camera_scanner(profile);
    std::vector<Came> all;
    std::vector<wire::CameraMessage> messages;
    std::map<std::uint64_t, HostTime> begins;
    std::uint64_t at = 0;
    for (const auto& [time, bytes] : sent) {
      begins[at] = time;
      at += bytes.size();
      messages.clear();
      scanner.push(bytes, messages);
      for (const auto& message : messages) all.push_back({message, begins.at(message.span.begin), time});
    }
    counters = scanner.counters();
    return all;
  }
  std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> all;
    for (const auto& [time, part] : sent) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  FakeBus bus;
  std::vector<std::pair<HostTime, std::vector<std::uint8_t>>> sent;
  io::I2cCamera camera{bus, "/dev/i2c-1", [this] { return bus.now; },
                       [this](std::span<const std::uint8_t> part) {
                         sent.emplace_back(bus.now, std::vector<std::uint8_t>(part.begin(), part.end()));
                       }};
  wire::Counters counters;
};

double lateness_s(const FakeBus& bus, HostTime begun) {
  double least = 1e9;
  for (const HostTime end : bus.measured)
    if (end <= begun) least = std::min(least, to_s(begun - end));
  return least;
}

TEST(I2cCamera, MakesAnImageOfEachHalfFrameAndBeginsItWithinTwoMillisecondsOfItsExposuresEnd) {
  for (const int digit : {4, 5}) {  // 8 and 16 a second
    SCOPED_TRACE(digit);
    Ridden rig;
    rig.find();
    rig.ask("MXR" + std::to_string(digit) + "\n");
    ASSERT_TRUE(rig.ride(10.0));
    const auto came = rig.came();
    const double due = 10.0 * std::ldexp(0.5, digit);
    EXPECT_NEAR(static_cast<double>(came.size()), due, 12.0) << "the first ones at the rate that it had";
    EXPECT_EQ(rig.counters.bytes_in_damaged, 0U);
    for (std::size_t i = 0; i < came.size(); ++i) {
      EXPECT_TRUE(came[i].message.fresh.one_fresh());
      EXPECT_LT(lateness_s(rig.bus, came[i].begun), 0.002);
      EXPECT_NEAR(to_s(came[i].read - came[i].begun), 0.0377, 0.002) << "832 words at 400 kHz";
      if (i > 0) {
        EXPECT_NE(came[i].message.fresh.even_fresh(), came[i - 1].message.fresh.even_fresh());
      }
    }
  }
}

TEST(I2cCamera, WritesNothingBelow0x8000) {
  Ridden rig;
  rig.find();
  rig.ask("MXR5\n");
  ASSERT_TRUE(rig.ride(3.0));
  EXPECT_THAT(rig.bus.written_to, SizeIs(2));
  EXPECT_THAT(rig.bus.written_to, Each(Ge(0x8000)));
}

TEST(I2cCamera, PutsASensorThatAnotherProgramHasSetOtherwiseIntoChessHalvesInTurn) {
  Ridden rig;
  rig.bus.memory[0x800D] = 0x0908;  // interleaved, one subpage again and again
  rig.find();
  rig.ask("MXR4\n");
  ASSERT_TRUE(rig.ride(2.0));
  EXPECT_EQ(rig.bus.memory[0x800D], 0x1A01);
  EXPECT_GE(rig.came().size(), 10U);
  EXPECT_EQ(rig.counters.bytes_in_damaged, 0U) << "what was begun before is left out";
}

TEST(I2cCamera, KeepsTheRateOfTheSensorUntilItIsAskedForOne) {
  Ridden rig;  // 2 a second, as from the factory
  rig.find();
  ASSERT_TRUE(rig.ride(4.0));
  EXPECT_NEAR(static_cast<double>(rig.came().size()), 7.0, 1.0);
  EXPECT_EQ(rig.bus.memory[0x800D], 0x1901);
}

/// A measurement ends while it is read: its last word shows it, and nothing of it becomes an image.
TEST(I2cCamera, PassesOnTornHalfFramesForWhatTheyAre) {
  Ridden rig;
  rig.find();
  rig.ask("MXR4\n");
  ASSERT_TRUE(rig.ride(3.0));
  rig.came();
  ASSERT_EQ(rig.counters.bytes_in_damaged, 0U);
  rig.bus.stall = std::chrono::milliseconds(110);
  ASSERT_TRUE(rig.ride(3.0));
  EXPECT_GE(rig.came().size(), 35U);
  EXPECT_EQ(rig.counters.bad_value, 1U);
  for (const auto& one : rig.came()) {
    const ThermalFrame& frame = one.message.frame;
    for (std::size_t place = 2; place < frame_pixels; ++place) {
      const std::size_t same = subpage_of(place / frame_columns, place % frame_columns) == 0 ? 0 : 1;
      ASSERT_NEAR(frame.temp_c[place], frame.temp_c[same], 0.2F) << "one half is of one measurement";
    }
  }
}

TEST(I2cCamera, RefusesHalfFramesOnlyWhenTheBusIsTooSlowForTheRateAndSaysSo) {
  Ridden rig;
  rig.bus.bus_hz = 100e3;
  rig.find();
  rig.ask("MXR4\n");
  ASSERT_TRUE(rig.ride(3.0));
  EXPECT_THAT(rig.came(), IsEmpty());
  const auto found = sensors::recognise(rig.bytes(), 3.0);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].evidence.advice,
              HasSubstr("takes 150 ms to read a half-frame, too long for 8 a second"));
  rig.ask("MXR3\n");
  ASSERT_TRUE(rig.ride(5.0));
  EXPECT_NEAR(static_cast<double>(rig.came().size()), 19.0, 2.0) << "4 a second it can do";
}

TEST(I2cCamera, ReadsASensorThatWasLeftTooFastForItsBusAsFastAsThatIs) {
  Ridden rig;
  rig.bus.bus_hz = 100e3;
  rig.bus.memory[0x800D] = 0x1B81;  // 64 a second
  rig.find();
  ASSERT_TRUE(rig.ride(5.0));
  EXPECT_NEAR(static_cast<double>(rig.came().size()), 18.0, 2.0);
}

TEST(I2cCamera, ReadsInPiecesWhereABridgeTakesNoMore) {
  Ridden rig;
  rig.bus.longest_read = 512;  // a CP2112
  rig.find();
  rig.ask("MXR4\n");
  ASSERT_TRUE(rig.ride(2.0));
  EXPECT_GE(rig.came().size(), 10U);
  EXPECT_EQ(rig.counters.bytes_in_damaged, 0U);
}

TEST(I2cCamera, OutlivesAnswersThatAreMissedAndIsGoneWhenTheyStayAway) {
  Ridden rig;
  rig.find();
  rig.ask("MXR4\n");
  ASSERT_TRUE(rig.ride(2.0));
  const std::size_t before = rig.came().size();
  rig.bus.failures = 5;
  ASSERT_TRUE(rig.ride(2.0));
  EXPECT_GE(rig.came().size(), before + 14);
  rig.bus.failures = 1'000'000;
  EXPECT_FALSE(rig.ride(2.0));
  EXPECT_THAT(rig.camera.why_gone(), HasSubstr("MLX90640 does not answer any more"));
}

TEST(I2cCamera, IsGoneAtOnceWhenItsBridgeIsPulledOut) {
  Ridden rig;
  rig.find();
  ASSERT_TRUE(rig.ride(1.0));
  rig.bus.is_unplugged = true;
  const HostTime pulled = rig.bus.now;
  EXPECT_FALSE(rig.ride(5.0));
  EXPECT_LT(to_s(rig.bus.now - pulled), 0.6) << "by the next turn";
  EXPECT_EQ(rig.camera.why_gone(), "unplugged");
}

TEST(I2cCamera, SaysWhatToLookAtWhereNoneAnswers) {
  Ridden rig;
  rig.bus.address = 0x29;
  try {
    rig.find();
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::device_missing);
    EXPECT_THAT(error.what_happened(), HasSubstr("0x33 (MLX90640) or 0x66 (MLX90642)"));
    EXPECT_THAT(error.advice(), HasSubstr("i2cdetect -y 1"));
  }
}

TEST(I2cCamera, ReadsTheTemperaturesOfAnMlx90642AndWritesNothingToIt) {
  Ridden rig;
  rig.bus.address = 0x66;
  rig.bus.address_step = 2;
  rig.bus.memory[0x11F0] = 4;
  rig.bus.memory[0x3A2C] = 2871;
  rig.find();
  rig.ask("MXR5\n");
  ASSERT_TRUE(rig.ride(3.0));
  const auto came = rig.came();
  ASSERT_GE(came.size(), 22U);
  EXPECT_NEAR(came[3].message.frame.temp_c[767], 20.0F + 4.0F / 50.0F, 1e-3);
  EXPECT_NEAR(came[3].message.frame.sensor_temp_c, 28.71F, 1e-3);
  EXPECT_TRUE(came[3].message.fresh.both_fresh());
  EXPECT_THAT(rig.bus.written_to, IsEmpty());
  rig.bus.memory[0x11F4] = 0x0100;
  EXPECT_THROW(rig.find(), Error);
}

std::vector<double> numbers_in(const std::string& name) {
  std::vector<double> numbers;
  auto bytes = read_capture("mlx90640_raw_frames/" + name);
  if (!bytes) return numbers;
  for (std::uint8_t& byte : *bytes)
    if (byte == ',' || byte == '\n' || byte == '\r' || byte == ';') byte = ' ';
  std::istringstream in(std::string(bytes->begin(), bytes->end()));
  for (std::string word; in >> word;) numbers.push_back(std::stod(word));
  return numbers;
}

TEST(I2cCamera, ARealSensorsWordsOnTheBusGiveTheTemperaturesOfTheMakersLibrary) {
  const auto eeprom = numbers_in("EEPROM-calibration-data.csv"), frames = numbers_in("raw-frame-data.csv");
  const auto expected = numbers_in("expected_To_emissivity0.95_trTa-8_melexis_lib_f6be7ca.csv");
  if (eeprom.empty() || frames.empty() || expected.empty()) GTEST_SKIP() << "its words are not at hand";
  RawMlx90640::Eeprom constants{};
  for (std::size_t i = 0; i < constants.size(); ++i) constants[i] = static_cast<std::uint16_t>(eeprom.at(i));
  Ridden rig([&](unsigned subpage) {  // the capture begins with subpage 1
    RawMlx90640::HalfFrame words{};
    for (std::size_t i = 0; i < words.size(); ++i)
      words[i] =
          static_cast<std::uint16_t>(static_cast<int>(frames.at((subpage == 1 ? 0 : words.size()) + i)));
    return words;
  });
  rig.bus.write_eeprom(constants);
  rig.bus.memory[0x800D] = static_cast<std::uint16_t>(static_cast<int>(frames.at(832)));
  rig.find();
  ASSERT_TRUE(rig.ride(5.0));
  const auto came = rig.came();
  ASSERT_GE(came.size(), 2U);
  for (std::size_t place = 0; place < frame_pixels; ++place)
    ASSERT_NEAR(came.back().message.frame.temp_c[place], expected.at(place), 0.01) << place;
}

}  // namespace
}  // namespace thermorig::test::i2c

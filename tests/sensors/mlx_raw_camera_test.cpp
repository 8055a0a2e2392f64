// SPDX-License-Identifier: MIT
// An MLX90640's own words, which the simulated sensor makes, and an MLX90642's temperatures, framed as
// protocols/mlx_raw.h says.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mlx_raw.h>

#include <cmath>

#include "simulation/raw_mlx90640.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "wire/scan.h"

namespace thermorig::test::mlx_raw {
namespace {

using simulation::RawMlx90640;
using ::testing::HasSubstr;

const RawMlx90640 sensor(1);

ByteVector message(std::uint8_t kind, std::span<const std::uint16_t> words) {
  ByteVector bytes(MLX_RAW_HEADER_BYTES);
  mlx_raw_header(bytes.data(), kind, static_cast<std::uint16_t>(words.size()));
  for (const std::uint16_t word : words) {
    bytes.push_back(static_cast<std::uint8_t>(word >> 8U));
    bytes.push_back(static_cast<std::uint8_t>(word & 0xFFU));
  }
  const std::uint16_t sum = mlx_raw_sum(0, bytes.data(), bytes.size());
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8U));
  bytes.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  return bytes;
}

ByteVector joined(std::initializer_list<ByteVector> parts) {
  ByteVector all;
  for (const ByteVector& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

ByteVector eeprom(const RawMlx90640::Eeprom& words = sensor.eeprom()) {
  return message(MLX_RAW_EEPROM, words);
}
ByteVector new_data(unsigned subpage = 0) {
  const std::array<std::uint16_t, 1> status{static_cast<std::uint16_t>(8U | subpage)};
  return message(MLX_RAW_NEW_DATA, status);
}
RawMlx90640::HalfFrame words_of(float temp_c, unsigned subpage) {
  std::array<float, frame_pixels> all_c{};
  all_c.fill(temp_c);
  return sensor.half_frame(all_c, subpage, {});
}
ByteVector half(float temp_c, unsigned subpage) {
  return message(MLX_RAW_HALF, words_of(temp_c, subpage));
}
ByteVector image(float temp_c, std::uint16_t flags = 0) {
  std::vector<std::uint16_t> words(frame_pixels, static_cast<std::uint16_t>(std::lround(50.0F * temp_c)));
  words.push_back(3150);
  words.push_back(flags);
  return message(MLX_RAW_IMAGE, words);
}

Scan<wire::CameraMessage> scan_of(const ByteVector& bytes) {
  CameraProfile profile;
  profile.protocol = "mlx-raw";
  return scan_any_chunking<wire::CameraMessage>(sensors::camera_scanner(profile), bytes, Stream::ends);
}

std::vector<sensors::Recognised> recognised(const ByteVector& bytes) {
  return sensors::recognise(bytes, 2.0);
}

// What becomes of the words is the same code as of an I2C-Stick, whose tests have it.

/// It was sent when the sensor had measured, before 40 ms of reading.
TEST(MlxRaw, AHalfFrameBeginsWithTheSignThatItIsThere) {
  const ByteVector before = joined({eeprom(), new_data(), half(20.0F, 0)});
  const auto scan = scan_of(joined({before, new_data(1), half(30.0F, 1)}));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.messages[0].span.begin, before.size());
  EXPECT_EQ(scan.messages[0].span.size(), new_data().size() + half(0.0F, 0).size());
}

TEST(MlxRaw, ASignWhoseHalfFrameNeverCameIsNoSignOfTrouble) {
  const auto scan =
      scan_of(joined({eeprom(), half(20.0F, 0), new_data(), new_data(1), half(30.0F, 1), new_data()}));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_FALSE(scan.messages[0].resync_before);
  EXPECT_EQ(scan.messages[0].span.size(), new_data().size() + half(0.0F, 0).size());
}

TEST(MlxRaw, ATornHalfFrameIsRefusedAndCountedWithItsSign) {
  auto torn = words_of(20.0F, 0);
  torn[833] |= 8U;
  const ByteVector bad = joined({new_data(), message(MLX_RAW_HALF, torn)});
  const auto scan =
      scan_of(joined({eeprom(), half(20.0F, 0), half(30.0F, 1), bad, new_data(), half(22.0F, 0)}));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_TRUE(scan.messages[1].resync_before);
  EXPECT_EQ(scan.counters.bad_value, 1U);
  EXPECT_EQ(scan.counters.bytes_in_damaged, bad.size());
}

TEST(MlxRaw, LostAndWrongBytesCostTheirMessageAndMoveNoWord) {
  const ByteVector begin = joined({eeprom(), half(20.0F, 0), half(30.0F, 1)}), end = half(22.0F, 0);
  const ByteVector middle = joined({new_data(1), half(32.0F, 1)});
  for (std::size_t at = 0; at < middle.size(); at += 201) {
    for (const std::size_t lost : {0U, 1U, 5U, 1200U}) {
      ByteVector damaged = middle;
      if (lost == 0) damaged[at] ^= 0x10U;
      const auto from = damaged.begin() + static_cast<std::ptrdiff_t>(at);
      damaged.erase(from, from + static_cast<std::ptrdiff_t>(std::min(lost, damaged.size() - at)));
      const auto scan = scan_of(joined({begin, damaged, end}));
      ASSERT_GE(scan.messages.size(), 2U) << at;
      const ThermalFrame& last = scan.messages.back().frame;
      EXPECT_NEAR(last.temp_c[0], 22.0F, 0.08F) << at;
      EXPECT_TRUE(std::abs(last.temp_c[1] - 31.0F) < 1.1F) << at;
      EXPECT_TRUE(scan.messages.size() == 3 || scan.messages.back().resync_before) << at;
    }
  }
}

TEST(MlxRaw, AnMlx90642sTemperaturesAreTakenAsTheyAre) {
  const auto scan = scan_of(joined({image(20.0F), image(21.5F), image(21.5F), image(22.0F, 0x0100)}));
  ASSERT_EQ(scan.messages.size(), 3U);
  EXPECT_TRUE(scan.messages[1].fresh.both_fresh());
  EXPECT_TRUE(scan.messages[2].fresh.none_fresh()) << "the same once more";
  EXPECT_EQ(scan.messages[1].frame.temp_c[100], 21.5F);
  EXPECT_EQ(scan.messages[1].frame.sensor_temp_c, 31.5F);
  EXPECT_EQ(scan.counters.bad_value, 1U) << "torn";
}

TEST(MlxRaw, IsRecognisedAndWhatIsWrongWithItIsNamed) {
  auto found = recognised(joined({eeprom(), new_data(), half(20.0F, 0), new_data(1), half(30.0F, 1)}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].protocol, "mlx-raw");
  EXPECT_TRUE(found[0].is_usable());
  EXPECT_THAT(found[0].evidence.text, HasSubstr("2 raw half-frame(s) of an MLX90640"));
  found = recognised(image(20.0F));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].evidence.text, HasSubstr("1 image(s) of an MLX90642"));
  auto words = sensor.eeprom();
  words.fill(0xFFFF);
  found = recognised(joined({eeprom(words), half(20.0F, 0)}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0].evidence.advice, HasSubstr("its EEPROM cannot be used"));
  EXPECT_TRUE(recognised(ByteVector(4000, MLX_RAW_MARK_0)).empty());
}

TEST(MlxRaw, ABusThatIsTooSlowIsNamedWithTheLineThatMakesItFaster) {
  const std::array<std::uint16_t, 2> slow{4, 152};  // 8 half-frames a second; ms
  const auto found = recognised(joined({eeprom(), message(MLX_RAW_TOO_SLOW, slow)}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].is_usable());
  EXPECT_THAT(found[0].evidence.advice,
              HasSubstr("takes 152 ms to read a half-frame, too long for 8 a second"));
  EXPECT_THAT(found[0].evidence.advice, HasSubstr("i2c_arm_baudrate=400000"));
}

}  // namespace
}  // namespace thermorig::test::mlx_raw

// SPDX-License-Identifier: MIT
// The MLX90640's chain from words to degrees Celsius, against words that the simulated sensor makes by that
// chain backwards, and against the data sheet's own example where it is at hand.
#include "thermorig/sensors/mlx90640_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "simulation/raw_mlx90640.h"
#include "support/captures.h"
#include "thermorig/core/error.h"

namespace thermorig::test::raw_camera {
namespace {

using namespace sensors::mlx90640;
using simulation::RawMlx90640;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using State = RawMlx90640::State;

constexpr double step_c = 0.08;  // one count, of a pixel in the middle, is 0.08 K at room temperature

std::array<float, frame_pixels> ramp(float from_c, float to_c) {
  std::array<float, frame_pixels> temp_c{};
  for (std::size_t place = 0; place < frame_pixels; ++place)
    temp_c[place] = from_c + (to_c - from_c) * static_cast<float>(place) / (frame_pixels - 1);
  return temp_c;
}

/// The largest error over both halves of a ramp of temperatures, degrees.
double worst_error(const RawMlx90640& sensor, const State& state, float from_c, float to_c) {
  const Parameters parameters = parameters_of(sensor.eeprom());
  const auto temp_c = ramp(from_c, to_c);
  double worst = 0.0;
  for (const unsigned subpage : {0U, 1U}) {
    const auto words = sensor.half_frame(temp_c, subpage, state);
    HalfFrame half;
    EXPECT_EQ(fault_of(words), HalfFrameFault::none);
    EXPECT_EQ(calibrate(parameters, words, {state.emissivity, state.reflected_below_sensor_k}, half),
              HalfFrameFault::none);
    EXPECT_EQ(half.subpage, subpage);
    EXPECT_NEAR(half.sensor_temp_c, state.sensor_temp_c, 0.02);
    EXPECT_NEAR(half.supply_v, state.supply_v, 0.001);
    for (std::size_t place = 0; place < frame_pixels; ++place) {
      const bool is_new = thermorig::subpage_of(place / frame_columns, place % frame_columns) == subpage;
      EXPECT_EQ(std::isfinite(half.temp_c[place]), is_new) << place;
      if (is_new) worst = std::max(worst, std::abs(half.temp_c[place] - static_cast<double>(temp_c[place])));
    }
  }
  return worst;
}

TEST(RawMlx90640Words, GiveBackTheTemperaturesOfARoom) {
  for (const std::uint64_t seed : {1U, 2U, 3U})
    EXPECT_LT(worst_error(RawMlx90640(seed), {}, 15.0F, 45.0F), step_c) << seed;
}

TEST(RawMlx90640Words, GiveBackThemAtAnySupplyWarmthResolutionAndEmissivity) {
  const RawMlx90640 sensor(1);
  for (const double supply_v : {3.0, 3.6})
    for (const double sensor_temp_c : {-5.0, 25.0, 60.0})
      EXPECT_LT(worst_error(sensor, {supply_v, sensor_temp_c, 2, 0.95, 8.0}, 15.0F, 45.0F), 1.2 * step_c)
          << supply_v << " V, " << sensor_temp_c << " degC";
  for (const unsigned resolution : {0U, 1U, 3U})
    EXPECT_LT(worst_error(sensor, {3.2, 35.0, resolution, 0.95, 8.0}, 15.0F, 45.0F), step_c) << resolution;
  EXPECT_LT(worst_error(sensor, {3.3, 35.0, 2, 0.7, 5.0}, 15.0F, 45.0F), 1.5 * step_c);
}

TEST(RawMlx90640Words, GiveBackThemInEveryRangeOfTheDataSheet) {
  const RawMlx90640 sensor(1);
  EXPECT_LT(worst_error(sensor, {}, -40.0F, 0.0F), 2.0 * step_c);
  EXPECT_LT(worst_error(sensor, {}, 130.0F, 150.0F), step_c);
  EXPECT_LT(worst_error(sensor, {}, 310.0F, 330.0F), 2.0 * step_c);
}

TEST(RawMlx90640Words, AreRefusedWhereTheyAreTornInterleavedOrNotMeasured) {
  const RawMlx90640 sensor(1);
  const auto sound = sensor.half_frame(ramp(20.0F, 30.0F), 1, {});
  auto words = sound;
  words[833] |= 8U;
  EXPECT_EQ(fault_of(words), HalfFrameFault::torn);
  words = sound;
  words[832] &= static_cast<std::uint16_t>(~0x1000U);
  EXPECT_EQ(fault_of(words), HalfFrameFault::interleaved);
  words = sound;
  words[1] = 0x7FFF;  // row 0, column 1: of the odd half
  EXPECT_EQ(fault_of(words), HalfFrameFault::unread);
  words = sound;
  words[0] = 0x7FFF;  // of the even half, which these words are not about
  EXPECT_EQ(fault_of(words), HalfFrameFault::none);
  words = sound;
  words[0x32A] = 0x7FFF;  // supply
  EXPECT_EQ(fault_of(words), HalfFrameFault::unread);
}

TEST(RawMlx90640Words, AreRefusedWhereNoSensorCouldHaveMeasuredThem) {
  const RawMlx90640 sensor(1);
  const Parameters parameters = parameters_of(sensor.eeprom());
  const auto sound = sensor.half_frame(ramp(20.0F, 30.0F), 0, {});
  HalfFrame half;
  for (const auto& [at, word] :
       {std::pair{0x30AU, 0U}, std::pair{0x32AU, 0U}, std::pair{0x320U, 0U}, std::pair{0U, 0x8000U}}) {
    auto words = sound;
    words[at] = static_cast<std::uint16_t>(word);
    EXPECT_EQ(calibrate(parameters, words, {}, half), HalfFrameFault::implausible) << at;
  }
}

TEST(RawMlx90640Eeprom, NamesBrokenPixelsAndOutliersWhichHaveNoTemperature) {
  const RawMlx90640 sensor(1);
  auto eeprom = sensor.eeprom();
  eeprom[0x40 + 34] = 0;
  eeprom[0x40 + 700] |= 1U;
  const Parameters parameters = parameters_of(eeprom);
  EXPECT_THAT(parameters.bad, ElementsAre(34, 700));
  for (const unsigned subpage : {0U, 1U}) {
    HalfFrame half;
    calibrate(parameters, sensor.half_frame(ramp(20.0F, 30.0F), subpage, {}), {}, half);
    EXPECT_TRUE(std::isnan(half.temp_c[34]) && std::isnan(half.temp_c[700]));
    EXPECT_TRUE(std::isfinite(half.temp_c[subpage]));
  }
}

TEST(RawMlx90640Eeprom, IsRefusedWithTheReason) {
  const auto sound = RawMlx90640(1).eeprom();
  const auto with = [&](unsigned address, unsigned word) {
    auto eeprom = sound;
    eeprom[address - 0x2400U] = static_cast<std::uint16_t>(word);
    return fault_of(eeprom);
  };
  EXPECT_THAT(fault_of(sound), IsEmpty());
  RawMlx90640::Eeprom silent;
  silent.fill(0xFFFF);
  EXPECT_THAT(fault_of(silent), HasSubstr("FFFF"));
  EXPECT_THAT(with(0x240A, 0x0040), HasSubstr("MLX90641"));
  EXPECT_THAT(with(0x2430, 0), HasSubstr("gain"));
  EXPECT_THAT(with(0x2433, 0), HasSubstr("supply"));
  EXPECT_THAT(with(0x243F, 0), HasSubstr("ranges"));
  EXPECT_THAT(with(0x2421, 0), HasSubstr("sensitivity"));
  auto outliers = sound;
  for (std::size_t i = 0; i < 5; ++i) outliers[0x50 + i] |= 1U;
  EXPECT_THAT(fault_of(outliers), HasSubstr("5 pixels"));
  EXPECT_THROW(parameters_of(outliers), Error);
}

// ---- the data sheet's example, and a real sensor --------------------------------------------------------

/// Numbers between commas, blanks and line ends; nothing where the file is not at hand.
std::vector<double> numbers_in(const std::string& name) {
  const auto bytes = read_capture(name);
  std::vector<double> numbers;
  if (!bytes) return numbers;
  std::string text(bytes->begin(), bytes->end());
  for (char& c : text)
    if (c == ',') c = ' ';
  std::istringstream in(text);
  for (double number = 0.0; in >> number;) numbers.push_back(number);
  return numbers;
}

template <std::size_t Size>
std::array<std::uint16_t, Size> words_of(const std::vector<double>& numbers, std::size_t from = 0) {
  std::array<std::uint16_t, Size> words{};
  for (std::size_t i = 0; i < Size; ++i) words[i] = static_cast<std::uint16_t>(numbers.at(from + i));
  return words;
}

TEST(RawMlx90640Example, GivesWhatTheDataSheetPrints) {
  const auto eeprom = numbers_in("mlx90640_datasheet_example/eeprom_words.csv");
  const auto frame = numbers_in("mlx90640_datasheet_example/frame_words.csv");
  if (eeprom.empty() || frame.empty()) GTEST_SKIP() << "the data sheet's example is not at hand";
  const Parameters sensor = parameters_of(words_of<eeprom_words>(eeprom));
  constexpr std::size_t pixel = 11 * 32 + 15;  // (12,16)
  EXPECT_EQ(sensor.kvdd, -3168.0);
  EXPECT_EQ(sensor.vdd25, -13056.0);
  EXPECT_EQ(sensor.vptat25, 12273.0);
  EXPECT_EQ(sensor.alpha_ptat, 9.0);
  EXPECT_NEAR(sensor.kv_ptat, 0.005371094, 1e-9);
  EXPECT_EQ(sensor.kt_ptat, 42.25);
  EXPECT_NEAR(sensor.gain / 0x1881, 1.01753546947234, 1e-14);
  EXPECT_EQ(sensor.offset[pixel], -75.0);
  EXPECT_EQ(sensor.kta[pixel], 0.005126953125);
  EXPECT_EQ(sensor.kv[pixel], 0.5);
  EXPECT_NEAR(sensor.alpha[pixel], 1.26223312690854e-7, 1e-21);
  EXPECT_NEAR(sensor.cp_alpha[0], 4.07453626394272e-9, 1e-23);
  EXPECT_NEAR(sensor.cp_alpha[1], 3.85171006200835e-9, 1e-23);
  EXPECT_EQ(sensor.ks_to[1], -0.00080108642578125);
  EXPECT_THAT(sensor.corner_c, ElementsAre(-40.0, 0.0, 160.0, 320.0));
  auto words = words_of<half_frame_words>(frame);
  words[832] |= 0x1000U;  // its text computes the chess pattern, its control word says rows
  words[833] = 0;
  HalfFrame half;
  ASSERT_EQ(calibrate(sensor, words, {1.0, 39.184 - 31.0}, half), HalfFrameFault::none);
  EXPECT_NEAR(half.supply_v, 3.3186, 0.00005);
  EXPECT_NEAR(half.sensor_temp_c, 39.184, 0.0005);
  const double alpha =
      (sensor.alpha[pixel] - sensor.tgc * sensor.cp_alpha[0]) * (1.0 + sensor.ks_ta * (39.184 - 25.0));
  EXPECT_NEAR(alpha, 1.1876487360496e-7, 1e-19);
  // It prints 80.3633, for which it subtracts the compensation pixel of the other half.
  EXPECT_NEAR(half.temp_c[pixel], 80.3633, 0.3);
}

TEST(RawMlx90640Example, ARealSensorsWordsGiveTheTemperaturesOfTheMakersLibrary) {
  const std::string folder = "mlx90640_raw_frames/";
  const auto eeprom = numbers_in(folder + "EEPROM-calibration-data.csv");
  const auto frames = numbers_in(folder + "raw-frame-data.csv");
  const auto expected = numbers_in(folder + "expected_To_emissivity0.95_trTa-8_melexis_lib_f6be7ca.csv");
  if (eeprom.empty() || frames.empty() || expected.empty()) GTEST_SKIP() << "its words are not at hand";
  const Parameters sensor = parameters_of(words_of<eeprom_words>(eeprom));
  std::size_t compared = 0;
  for (const std::size_t from : {std::size_t{0}, half_frame_words}) {
    HalfFrame half;
    const auto words = words_of<half_frame_words>(frames, from);
    ASSERT_EQ(calibrate(sensor, words, {}, half), HalfFrameFault::none);
    EXPECT_NEAR(half.sensor_temp_c, 25.750, 0.001);
    for (std::size_t place = 0; place < frame_pixels; ++place) {
      if (std::isnan(half.temp_c[place])) continue;
      ASSERT_NEAR(half.temp_c[place], expected.at(place), 0.01) << place;
      ++compared;
    }
  }
  EXPECT_EQ(compared, frame_pixels);
}

}  // namespace
}  // namespace thermorig::test::raw_camera

// SPDX-License-Identifier: MIT
#include "raw_mlx90640.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace thermorig::simulation {

namespace {

// The made-up sensor, in the units of its EEPROM. Signs and sizes are those of the data sheet's example.
constexpr int gain = 6000, ptat_25 = 12200, ptat_slope = 340, ptat_supply = 20, ptat_share = 4;
constexpr int supply_slope = -99, supply_25 = 104, resolution = 2;
constexpr int mean_offset = -70, row_offset_scale = 0, column_offset_scale = 1, pixel_offset_scale = 0;
constexpr int mean_sensitivity = 17000, sensitivity_scale = 7, row_sensitivity_scale = 8,
              column_sensitivity_scale = 8, pixel_sensitivity_scale = 5;
constexpr int kta_scale = 5, kta_pixel_scale = 2, kv_scale = 3;
constexpr std::array<int, 4> kta_of_parity{66, 60, 72, 63};  // row odd: column odd, even; row even: the same
constexpr std::array<int, 4> kv_of_parity{3, 4, 2, 5};
constexpr int gradient = 8, sensitivity_warmth = -16;  // of 32; of 8192
constexpr int cp_sensitivity = 500, cp_second = -4, cp_offset = -60, cp_offset_second = -3, cp_kta = 58,
              cp_kv = 3;
constexpr int range_scale = 9, range_step = 2, corner_3 = 7, corner_4 = 9;  // in 20 K: 140 and 320 degC
constexpr std::array<int, 4> range_slopes{-100, -104, -96, -90};
constexpr double zero_k = 273.15;

double two_to(int exponent) {
  return std::ldexp(1.0, exponent);
}

double radiant(double temp_c) {
  return std::pow(temp_c + zero_k, 4.0);
}

std::uint16_t word_of(double counts) {
  const double held = std::clamp(std::round(counts), -32768.0, 32766.0);  // 32767 stands for "not measured"
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(held));
}

}  // namespace

RawMlx90640::RawMlx90640(std::uint64_t seed) {
  make_common();
  make_pixels(seed);
}

/// `size` bits of a word from bit `low` on, two's complement.
void RawMlx90640::put(unsigned address, unsigned low, unsigned size, int value) {
  const unsigned mask = ((1U << size) - 1U) << low;
  std::uint16_t& word = eeprom_[address - 0x2400U];
  word = static_cast<std::uint16_t>((word & ~mask) | ((static_cast<unsigned>(value) << low) & mask));
}

void RawMlx90640::make_common() {
  put(0x2407, 0, 16, 0x5117);  // its identity
  put(0x2410, 12, 4, ptat_share);
  put(0x2410, 8, 4, row_offset_scale);
  put(0x2410, 4, 4, column_offset_scale);
  put(0x2410, 0, 4, pixel_offset_scale);
  put(0x2411, 0, 16, mean_offset);
  put(0x2420, 12, 4, sensitivity_scale);
  put(0x2420, 8, 4, row_sensitivity_scale);
  put(0x2420, 4, 4, column_sensitivity_scale);
  put(0x2420, 0, 4, pixel_sensitivity_scale);
  put(0x2421, 0, 16, mean_sensitivity);
  put(0x2430, 0, 16, gain);
  put(0x2431, 0, 16, ptat_25);
  put(0x2432, 10, 6, ptat_supply);
  put(0x2432, 0, 10, ptat_slope);
  put(0x2433, 8, 8, supply_slope);
  put(0x2433, 0, 8, supply_25);
  put(0x2434, 12, 4, kv_of_parity[0]);
  put(0x2434, 8, 4, kv_of_parity[2]);
  put(0x2434, 4, 4, kv_of_parity[1]);
  put(0x2434, 0, 4, kv_of_parity[3]);
  put(0x2436, 8, 8, kta_of_parity[0]);
  put(0x2436, 0, 8, kta_of_parity[2]);
  put(0x2437, 8, 8, kta_of_parity[1]);
  put(0x2437, 0, 8, kta_of_parity[3]);
  put(0x2438, 12, 2, resolution);
  put(0x2438, 8, 4, kv_scale);
  put(0x2438, 4, 4, kta_scale);
  put(0x2438, 0, 4, kta_pixel_scale);
  put(0x2439, 10, 6, cp_second);
  put(0x2439, 0, 10, cp_sensitivity);
  put(0x243A, 10, 6, cp_offset_second);
  put(0x243A, 0, 10, cp_offset);
  put(0x243B, 8, 8, cp_kv);
  put(0x243B, 0, 8, cp_kta);
  put(0x243C, 8, 8, sensitivity_warmth);
  put(0x243C, 0, 8, gradient);
  put(0x243D, 0, 8, range_slopes[0]);
  put(0x243D, 8, 8, range_slopes[1]);
  put(0x243E, 0, 8, range_slopes[2]);
  put(0x243E, 8, 8, range_slopes[3]);
  put(0x243F, 12, 2, range_step);
  put(0x243F, 8, 4, corner_4);
  put(0x243F, 4, 4, corner_3);
  put(0x243F, 0, 4, range_scale);
}

/// Rows, columns and pixels differ at random, the outer ones seeing less as behind any lens.
void RawMlx90640::make_pixels(std::uint64_t seed) {
  Random random(seed, "raw camera");
  std::array<int, frame_rows> row_offset{}, row_sensitivity{};
  std::array<int, frame_columns> column_offset{}, column_sensitivity{};
  for (std::size_t row = 0; row < frame_rows; ++row) {
    row_offset[row] = random.integer(-8, 7);
    const double off = (static_cast<double>(row) - 11.5) / 11.5;
    row_sensitivity[row] = 3 - static_cast<int>(std::lround(8.0 * off * off));
    const auto low = static_cast<unsigned>(row % 4) * 4U, word = static_cast<unsigned>(row / 4);
    put(0x2412U + word, low, 4, row_offset[row]);
    put(0x2422U + word, low, 4, row_sensitivity[row]);
  }
  for (std::size_t column = 0; column < frame_columns; ++column) {
    column_offset[column] = random.integer(-8, 7);
    const double off = (static_cast<double>(column) - 15.5) / 15.5;
    column_sensitivity[column] = 3 - static_cast<int>(std::lround(9.0 * off * off));
    const auto low = static_cast<unsigned>(column % 4) * 4U, word = static_cast<unsigned>(column / 4);
    put(0x2418U + word, low, 4, column_offset[column]);
    put(0x2428U + word, low, 4, column_sensitivity[column]);
  }
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    const std::size_t row = place / frame_columns, column = place % frame_columns;
    const int offset = random.integer(-32, 31), sensitivity = random.integer(-32, 31);
    const int kta = random.integer(-3, 3);
    const unsigned at = 0x2440U + static_cast<unsigned>(place);
    put(at, 10, 6, offset);
    put(at, 4, 6, sensitivity);
    put(at, 1, 3, kta);
    if (eeprom_[at - 0x2400U] == 0) put(at, 1, 3, 1);  // a word of 0 is a broken pixel
    const std::size_t parity = 2 * (row % 2) + column % 2;
    const int kta_written = eeprom_[at - 0x2400U] == 2 ? 1 : kta;
    pixels_[place] = {
        mean_offset + row_offset[row] * two_to(row_offset_scale) +
            column_offset[column] * two_to(column_offset_scale) + offset * two_to(pixel_offset_scale),
        (mean_sensitivity + row_sensitivity[row] * two_to(row_sensitivity_scale) +
         column_sensitivity[column] * two_to(column_sensitivity_scale) +
         sensitivity * two_to(pixel_sensitivity_scale)) *
            two_to(-30 - sensitivity_scale),
        (kta_of_parity[parity] + kta_written * two_to(kta_pixel_scale)) * two_to(-8 - kta_scale),
        kv_of_parity[parity] * two_to(-kv_scale)};
  }
}

/// Counts that an object of that temperature gives: sensitivity by its range (data sheet, 11.2.2.9.1.1).
double RawMlx90640::radiation(double temp_c, double sensitivity, double background) const {
  const double scale = two_to(-8 - range_scale);
  const double third_c = corner_3 * range_step * 10.0, fourth_c = third_c + corner_4 * range_step * 10.0;
  const auto slope = [&](std::size_t range, double from_c, double to_c) {
    return 1.0 + range_slopes[range] * scale * (to_c - from_c);
  };
  double seen = sensitivity;
  if (temp_c < 0.0)
    seen *= slope(0, -40.0, temp_c) / slope(0, -40.0, 0.0);
  else if (temp_c < third_c)
    seen *= slope(1, 0.0, temp_c);
  else if (temp_c < fourth_c)
    seen *= slope(1, 0.0, third_c) * slope(2, third_c, temp_c);
  else
    seen *= slope(1, 0.0, third_c) * slope(2, third_c, fourth_c) * slope(3, fourth_c, temp_c);
  return seen * (radiant(temp_c) - background);
}

RawMlx90640::HalfFrame RawMlx90640::half_frame(const std::array<float, frame_pixels>& temp_c,
                                               unsigned subpage, const State& state) const {
  HalfFrame words{};
  const auto ram = [&](unsigned address) -> std::uint16_t& { return words[address - 0x0400U]; };
  const double warmer_k = state.sensor_temp_c - 25.0, above_v = state.supply_v - 3.3;
  const double amplified = 1.03;  // by the sensor now; at the factory, 1
  ram(0x070A) = word_of(gain * amplified);
  const double now = static_cast<double>(ram(0x070A)) / gain;

  const double supply_counts = (supply_25 - 256) * 32.0 - 8192.0 + supply_slope * 32.0 * above_v;
  ram(0x072A) = word_of(supply_counts * two_to(static_cast<int>(state.resolution) - resolution));

  // PTAT: v = p / (p a + b) 2^18, with any p; from v follows b.
  const double wanted = (ptat_25 + ptat_slope / 8.0 * warmer_k) * (1.0 + ptat_supply / 4096.0 * above_v);
  const double ptat = 1700.0;
  ram(0x0720) = word_of(ptat);
  ram(0x0700) = word_of(ptat * 262144.0 / wanted - ptat * (ptat_share / 4.0 + 8.0));

  const double cp_sensitivity_now =
      cp_sensitivity * two_to(-27 - sensitivity_scale) * (subpage == 1 ? 1.0 + cp_second / 128.0 : 1.0);
  const double cp_offset_now = (cp_offset + (subpage == 1 ? cp_offset_second : 0)) *
                               (1.0 + cp_kta * two_to(-8 - kta_scale) * warmer_k) *
                               (1.0 + cp_kv * two_to(-kv_scale) * above_v);
  const double cp_sees = 12.0;  // counts: the warmth of its own case
  ram(0x0708) = ram(0x0728) = word_of((cp_sees + cp_offset_now) * now);
  const double cp_read = static_cast<std::int16_t>(ram(0x0708)) / now - cp_offset_now;

  const double own = radiant(state.sensor_temp_c);
  const double reflected = radiant(state.sensor_temp_c - state.reflected_below_sensor_k);
  const double background = reflected - (reflected - own) / state.emissivity;
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    if (subpage_of(place / frame_columns, place % frame_columns) != subpage) continue;
    const Pixel& pixel = pixels_[place];
    const double sensitivity = (pixel.sensitivity - gradient / 32.0 * cp_sensitivity_now) *
                               (1.0 + sensitivity_warmth / 8192.0 * warmer_k);
    const double counts =
        radiation(static_cast<double>(temp_c[place]), sensitivity, background) * state.emissivity +
        gradient / 32.0 * cp_read + pixel.offset * (1.0 + pixel.kta * warmer_k) * (1.0 + pixel.kv * above_v);
    words[place] = word_of(counts * now);
  }
  words[832] = static_cast<std::uint16_t>(0x1001U | (state.resolution << 10U) | (5U << 7U));
  words[833] = static_cast<std::uint16_t>(subpage);
  return words;
}

}  // namespace thermorig::simulation

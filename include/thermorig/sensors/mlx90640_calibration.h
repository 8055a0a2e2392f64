// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "thermorig/core/bad_pixels.h"
#include "thermorig/core/frame.h"

/// What an MLX90640 measures, from its own words to degrees Celsius. Source of all formulas: its data sheet,
/// section 11.2 ("Calculations"); each function names the part.
namespace thermorig::sensors::mlx90640 {

/// Words of 16 bits, as the sensor has them.
inline constexpr std::size_t eeprom_words = 832;      // addresses 0x2400 to 0x273F
inline constexpr std::size_t half_frame_words = 834;  // RAM 0x0400 to 0x073F; control 0x800D; status 0x8000
using EepromWords = std::span<const std::uint16_t, eeprom_words>;
using HalfFrameWords = std::span<const std::uint16_t, half_frame_words>;

/// What the factory has measured of one sensor (11.2.2). Per pixel: row-major, 24 x 32.
struct Parameters {
  using Pixels = std::array<double, frame_pixels>;
  double kvdd = 0.0, vdd25 = 0.0;  // counts a volt; counts at 25 degC
  unsigned resolution = 0;         // bits of the converter beyond 16
  double kv_ptat = 0.0, kt_ptat = 0.0, vptat25 = 0.0, alpha_ptat = 0.0;
  double gain = 0.0;
  double tgc = 0.0;               // temperature gradient coefficient
  double ks_ta = 0.0;             // a kelvin
  std::array<double, 4> ks_to{};  // of the ranges from -40 degC, 0 degC, corner 3, corner 4; a kelvin
  std::array<double, 4> corner_c{};
  Pixels offset{}, alpha{}, kta{}, kv{};
  std::array<double, 2> cp_offset{}, cp_alpha{};  // compensation pixel, of each half
  double cp_kta = 0.0, cp_kv = 0.0;
  std::array<double, 3> il_chess{};  // C1 to C3: between both reading patterns
  bool is_chess = true;              // the reading pattern that the factory used
  PixelPlaces bad;                   // broken (word 0) or outlier (lowest bit), by the EEPROM
};

/// Why the words cannot be an MLX90640's EEPROM, in words; empty if they can. It has no check sum: all words
/// alike, another device's select flag, more deviating pixels than the data sheet allows (4), and constants
/// with which nothing can be computed are refused.
std::string fault_of(EepromWords words);

/// The constants in an EEPROM of which fault_of() says nothing. Throws Error(bad_usage) with that fault.
Parameters parameters_of(EepromWords words);

/// What is assumed of the scene. Source: the data sheet's own advice for a sensor in open air (11.2.2.9).
struct Surroundings {
  double emissivity = 0.95;
  double reflected_below_sensor_k = 8.0;  // what surfaces reflect is so much colder than the sensor
};

struct HalfFrame {
  unsigned subpage = 0;        // 0: even half; 1: odd half
  double supply_v = 0.0;       // Vdd
  double sensor_temp_c = 0.0;  // Ta
  /// Degrees Celsius of the 384 pixels of this half, finite but where the pixel is bad; the others are NaN.
  std::array<double, frame_pixels> temp_c{};
};

/// Why words of a half-frame cannot be used.
enum class HalfFrameFault : std::uint8_t {
  none,
  torn,         // the sensor had begun to write the next one: status word, bit 3
  interleaved,  // it reads whole rows, no chess halves: control word, bit 12
  unread,       // words that it has not measured (0x7FFF)
  implausible,  // no supply, sensor or object temperature that it could have
};

/// Computes the pixels of one half (11.2.2.1 to 11.2.2.9) into `out`, in either reading pattern. `out` is of
/// use only if the answer is `none`; else it is `implausible`. What fault_of() says is not looked at.
HalfFrameFault calibrate(const Parameters& sensor, HalfFrameWords words, const Surroundings& surroundings,
                         HalfFrame& out);

/// Faults that the words show by themselves: torn, interleaved, unread.
HalfFrameFault fault_of(HalfFrameWords words);

/// 0 or 1, by the status word.
unsigned subpage_of(HalfFrameWords words);

}  // namespace thermorig::sensors::mlx90640

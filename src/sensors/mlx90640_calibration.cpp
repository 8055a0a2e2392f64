// SPDX-License-Identifier: MIT
#include "thermorig/sensors/mlx90640_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "thermorig/core/error.h"

namespace thermorig::sensors::mlx90640 {

namespace {

constexpr double zero_c_k = 273.15;
constexpr double nominal_supply_v = 3.3, nominal_temp_c = 25.0;
constexpr std::size_t most_bad_pixels = 4;          // data sheet, table 10, note 3
constexpr std::uint16_t unread_word = 0x7FFF;       // what stands where nothing was measured yet
constexpr unsigned device_select = 1U << 6U;        // of 0x240A: set in an MLX90641
constexpr unsigned interleaved_eeprom = 1U << 11U;  // of 0x240A
constexpr unsigned chess_control = 1U << 12U;       // of 0x800D
constexpr unsigned new_data_status = 1U << 3U;      // of 0x8000

/// The word at an address of the EEPROM.
class Eeprom {
 public:
  explicit Eeprom(EepromWords words) : words_(words) {}
  std::uint16_t word(unsigned address) const { return words_[address - 0x2400U]; }
  unsigned bits(unsigned address, unsigned high, unsigned low) const {
    return (unsigned{word(address)} >> low) & ((1U << (high - low + 1U)) - 1U);
  }
  /// Two's complement in those bits.
  int number(unsigned address, unsigned high, unsigned low) const {
    const int size = 1 << (high - low + 1U), value = static_cast<int>(bits(address, high, low));
    return value < size / 2 ? value : value - size;
  }
  /// The signed nibble `index` of those from an address on, four a word, the lowest first.
  int nibble(unsigned address, std::size_t index) const {
    const auto low = static_cast<unsigned>(index % 4) * 4U;
    return number(address + static_cast<unsigned>(index / 4), low + 3U, low);
  }
  std::uint16_t pixel(std::size_t place) const { return word(0x2440U + static_cast<unsigned>(place)); }

 private:
  EepromWords words_;
};

double power_of_2(unsigned exponent) {
  return std::ldexp(1.0, static_cast<int>(exponent));
}

/// 11.2.2.1 and 11.2.2.3: supply, sensor temperature; 11.2.2.4: gain.
void read_common(const Eeprom& eeprom, Parameters& sensor) {
  sensor.kvdd = eeprom.number(0x2433, 15, 8) * 32.0;
  sensor.vdd25 = (static_cast<double>(eeprom.bits(0x2433, 7, 0)) - 256.0) * 32.0 - 8192.0;
  sensor.resolution = eeprom.bits(0x2438, 13, 12);
  sensor.kv_ptat = eeprom.number(0x2432, 15, 10) / 4096.0;
  sensor.kt_ptat = eeprom.number(0x2432, 9, 0) / 8.0;
  sensor.vptat25 = eeprom.number(0x2431, 15, 0);
  sensor.alpha_ptat = eeprom.bits(0x2410, 15, 12) / 4.0 + 8.0;
  sensor.gain = eeprom.number(0x2430, 15, 0);
  sensor.tgc = eeprom.number(0x243C, 7, 0) / 32.0;
  sensor.ks_ta = eeprom.number(0x243C, 15, 8) / 8192.0;
  sensor.is_chess = (eeprom.word(0x240A) & interleaved_eeprom) == 0;
  sensor.il_chess = {eeprom.number(0x2435, 5, 0) / 16.0, eeprom.number(0x2435, 10, 6) / 2.0,
                     eeprom.number(0x2435, 15, 11) / 8.0};
}

/// 11.2.2.9.1.1: what the sensitivity does in each range of object temperatures.
void read_ranges(const Eeprom& eeprom, Parameters& sensor) {
  const double scale = power_of_2(eeprom.bits(0x243F, 3, 0) + 8U);
  sensor.ks_to = {eeprom.number(0x243D, 7, 0) / scale, eeprom.number(0x243D, 15, 8) / scale,
                  eeprom.number(0x243E, 7, 0) / scale, eeprom.number(0x243E, 15, 8) / scale};
  const double step_c = eeprom.bits(0x243F, 13, 12) * 10.0;
  const double third_c = eeprom.bits(0x243F, 7, 4) * step_c;
  sensor.corner_c = {-40.0, 0.0, third_c, third_c + eeprom.bits(0x243F, 11, 8) * step_c};
}

/// 11.2.2.5.2, 11.2.2.5.3 and 11.2.2.8: offset, its change with temperature and supply, sensitivity.
void read_pixels(const Eeprom& eeprom, Parameters& sensor) {
  const double row_scale = power_of_2(eeprom.bits(0x2410, 11, 8));
  const double column_scale = power_of_2(eeprom.bits(0x2410, 7, 4));
  const double rest_scale = power_of_2(eeprom.bits(0x2410, 3, 0));
  const double alpha_scale = power_of_2(eeprom.bits(0x2420, 15, 12) + 30U);
  const double alpha_row_scale = power_of_2(eeprom.bits(0x2420, 11, 8));
  const double alpha_column_scale = power_of_2(eeprom.bits(0x2420, 7, 4));
  const double alpha_rest_scale = power_of_2(eeprom.bits(0x2420, 3, 0));
  const double kta_scale = power_of_2(eeprom.bits(0x2438, 7, 4) + 8U);
  const double kta_rest_scale = power_of_2(eeprom.bits(0x2438, 3, 0));
  const double kv_scale = power_of_2(eeprom.bits(0x2438, 11, 8));
  const double offset = eeprom.number(0x2411, 15, 0), alpha = eeprom.word(0x2421);
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    const std::size_t row = place / frame_columns, column = place % frame_columns;
    const unsigned at = 0x2440U + static_cast<unsigned>(place);
    sensor.offset[place] = offset + eeprom.nibble(0x2412, row) * row_scale +
                           eeprom.nibble(0x2418, column) * column_scale +
                           eeprom.number(at, 15, 10) * rest_scale;
    sensor.alpha[place] =
        (alpha + eeprom.nibble(0x2422, row) * alpha_row_scale +
         eeprom.nibble(0x2428, column) * alpha_column_scale + eeprom.number(at, 9, 4) * alpha_rest_scale) /
        alpha_scale;
    // The data sheet counts rows and columns from 1: the first of each is odd.
    const bool is_even_row = row % 2 == 1, is_even_column = column % 2 == 1;
    const unsigned kta_at = is_even_column ? 0x2437U : 0x2436U, low = is_even_row ? 0U : 8U;
    const unsigned kv_low = (is_even_column ? 0U : 8U) + (is_even_row ? 0U : 4U);
    sensor.kta[place] =
        (eeprom.number(kta_at, low + 7U, low) + eeprom.number(at, 3, 1) * kta_rest_scale) / kta_scale;
    sensor.kv[place] = eeprom.number(0x2434, kv_low + 3U, kv_low) / kv_scale;
  }
  // 11.2.2.6.2 and 11.2.2.8: the compensation pixel, which sees nothing of the scene.
  const double cp_alpha_scale = power_of_2(eeprom.bits(0x2420, 15, 12) + 27U);
  const double cp_alpha = eeprom.bits(0x2439, 9, 0) / cp_alpha_scale;
  sensor.cp_alpha = {cp_alpha, cp_alpha * (1.0 + eeprom.number(0x2439, 15, 10) / 128.0)};
  const double cp_offset = eeprom.number(0x243A, 9, 0);
  sensor.cp_offset = {cp_offset, cp_offset + eeprom.number(0x243A, 15, 10)};
  sensor.cp_kta = eeprom.number(0x243B, 7, 0) / kta_scale;
  sensor.cp_kv = eeprom.number(0x243B, 15, 8) / kv_scale;
}

PixelPlaces bad_pixels(const Eeprom& eeprom) {
  PixelPlaces bad;
  for (std::size_t place = 0; place < frame_pixels; ++place)
    if (eeprom.pixel(place) == 0 || (eeprom.pixel(place) & 1U) != 0)
      bad.push_back(static_cast<std::uint16_t>(place));
  return bad;
}

bool is_bad(const Parameters& sensor, std::size_t place) {
  return std::find(sensor.bad.begin(), sensor.bad.end(), place) != sensor.bad.end();
}

Parameters read_parameters(const Eeprom& eeprom) {
  Parameters sensor;
  sensor.bad = bad_pixels(eeprom);
  read_common(eeprom, sensor);
  read_ranges(eeprom, sensor);
  read_pixels(eeprom, sensor);
  return sensor;
}

/// The compensation pixel's share is taken off each pixel's sensitivity: what is left must be positive.
bool has_sensitive_pixels(const Parameters& sensor) {
  const double off = sensor.tgc * std::max(sensor.cp_alpha[0], sensor.cp_alpha[1]);
  for (std::size_t place = 0; place < frame_pixels; ++place)
    if (!is_bad(sensor, place) && sensor.alpha[place] - off <= 0.0) return false;
  return true;
}

/// The RAM's word at an address, two's complement.
double ram(HalfFrameWords words, unsigned address) {
  return static_cast<std::int16_t>(words[address - 0x0400U]);
}

unsigned control_of(HalfFrameWords words) {
  return words[half_frame_words - 2];
}
unsigned status_of(HalfFrameWords words) {
  return words[half_frame_words - 1];
}

double fourth_root(double value) {
  return std::sqrt(std::sqrt(value));
}

double fourth_power(double value) {
  return value * value * value * value;
}

/// 11.2.2.2 and 11.2.2.1: volts, whatever resolution the converter is set to.
double supply_of(const Parameters& sensor, HalfFrameWords words) {
  const double resolution = power_of_2(sensor.resolution) / power_of_2((control_of(words) >> 10U) & 3U);
  return (resolution * ram(words, 0x072A) - sensor.vdd25) / sensor.kvdd + nominal_supply_v;
}

/// 11.2.2.3: degrees Celsius.
double sensor_temp_of(const Parameters& sensor, HalfFrameWords words, double supply_v) {
  const double ptat = ram(words, 0x0720);
  const double art = ptat / (ptat * sensor.alpha_ptat + ram(words, 0x0700)) * 262144.0;
  return (art / (1.0 + sensor.kv_ptat * (supply_v - nominal_supply_v)) - sensor.vptat25) / sensor.kt_ptat +
         nominal_temp_c;
}

/// All that the pixels of one half have in common.
struct Conditions {
  double gain = 0.0;
  double warmer_k = 0.0;      // than 25 degC
  double above_v = 0.0;       // 3.3 V
  double compensation = 0.0;  // counts of the compensation pixel, by its gradient coefficient
  double cp_alpha = 0.0;
  double background = 0.0;  // fourth power of kelvin: what the sensor and reflections radiate
  double emissivity = 1.0;
  bool is_other_pattern = false;  // than the factory's
};

/// 11.2.2.6: the compensation pixel; 11.2.2.9: reflections.
Conditions conditions_of(const Parameters& sensor, HalfFrameWords words, const HalfFrame& half,
                         const Surroundings& surroundings) {
  Conditions now;
  const bool is_chess = (control_of(words) & chess_control) != 0;
  now.gain = sensor.gain / ram(words, 0x070A);
  now.warmer_k = half.sensor_temp_c - nominal_temp_c;
  now.above_v = half.supply_v - nominal_supply_v;
  now.is_other_pattern = is_chess != sensor.is_chess;
  now.emissivity = surroundings.emissivity;
  const unsigned subpage = half.subpage;
  const double cp_offset =
      sensor.cp_offset[subpage] + (subpage == 1 && now.is_other_pattern ? sensor.il_chess[0] : 0.0);
  const double cp = now.gain * ram(words, subpage == 0 ? 0x0708 : 0x0728) -
                    cp_offset * (1.0 + sensor.cp_kta * now.warmer_k) * (1.0 + sensor.cp_kv * now.above_v);
  now.compensation = sensor.tgc * cp;
  now.cp_alpha = sensor.tgc * sensor.cp_alpha[subpage];
  const double sensor_k = half.sensor_temp_c + zero_c_k;
  const double reflected = fourth_power(sensor_k - surroundings.reflected_below_sensor_k);
  now.background = reflected - (reflected - fourth_power(sensor_k)) / surroundings.emissivity;
  return now;
}

/// 11.2.2.5: what the pixel receives, in counts. The compensation pixel is taken off before the emissivity is
/// applied, as in the maker's own library: the body's warmth does not come from the scene. The data sheet has
/// the other order; both agree for sensors without a gradient coefficient, which are those on boards.
double radiation_of(const Parameters& sensor, const Conditions& now, std::size_t place, double raw) {
  double counts = now.gain * raw - sensor.offset[place] * (1.0 + sensor.kta[place] * now.warmer_k) *
                                       (1.0 + sensor.kv[place] * now.above_v);
  if (now.is_other_pattern) {  // 11.3.1
    const bool is_odd_row = (place / frame_columns) % 2 == 1;
    constexpr std::array<int, 4> conversion{0, -1, 0, 1};  // along the columns, turned round in each row
    const int pattern = conversion[place % 4] * (is_odd_row ? -1 : 1);
    counts += sensor.il_chess[2] * (is_odd_row ? 1.0 : -1.0) - sensor.il_chess[1] * pattern;
  }
  return (counts - now.compensation) / now.emissivity;
}

/// 11.2.2.9: degrees Celsius, or NaN where nothing could radiate that.
double object_temp_of(const Parameters& sensor, const Conditions& now, std::size_t place, double counts) {
  const double alpha = (sensor.alpha[place] - now.cp_alpha) * (1.0 + sensor.ks_ta * now.warmer_k);
  const double slope = sensor.ks_to[1];
  const double bend = slope * fourth_root(alpha * alpha * alpha * (counts + alpha * now.background));
  const double first_c =
      fourth_root(counts / (alpha * (1.0 - slope * zero_c_k) + bend) + now.background) - zero_c_k;
  const auto& corner_c = sensor.corner_c;
  const auto& ks_to = sensor.ks_to;
  double sensitivity = 1.0;
  std::size_t range = 1;
  if (first_c < corner_c[1]) {
    range = 0;
    sensitivity = 1.0 / (1.0 + ks_to[0] * (corner_c[1] - corner_c[0]));
  } else if (first_c >= corner_c[2]) {
    range = 2;
    sensitivity = 1.0 + ks_to[1] * (corner_c[2] - corner_c[1]);
    if (first_c >= corner_c[3]) {
      range = 3;
      sensitivity *= 1.0 + ks_to[2] * (corner_c[3] - corner_c[2]);
    }
  }
  const double ranged = alpha * sensitivity * (1.0 + ks_to[range] * (first_c - corner_c[range]));
  return fourth_root(counts / ranged + now.background) - zero_c_k;
}

/// What the sensor bears (data sheet, tables 4 and 6): beyond it the words are no measurement.
bool is_plausible(const HalfFrame& half) {
  return half.supply_v > 2.5 && half.supply_v < 5.0 && half.sensor_temp_c > -50.0 &&
         half.sensor_temp_c < 125.0;
}

}  // namespace

std::string fault_of(EepromWords words) {
  if (std::all_of(words.begin(), words.end(), [&](std::uint16_t word) { return word == words[0]; }))
    return fmt::format("all its words are {:04X}: the sensor did not answer", words[0]);
  const Eeprom eeprom(words);
  if ((eeprom.word(0x240A) & device_select) != 0)
    return "its device select flag (0x240A, bit 6) is that of an MLX90641";
  const std::size_t bad = bad_pixels(eeprom).size();
  if (bad > most_bad_pixels)
    return fmt::format("it marks {} pixels as broken or outliers; a sound sensor has at most {}", bad,
                       most_bad_pixels);
  const Parameters sensor = read_parameters(eeprom);
  if (sensor.kvdd == 0.0 || sensor.kt_ptat <= 0.0 || sensor.vptat25 <= 0.0 || sensor.gain <= 0.0)
    return "supply, temperature or gain (0x2430 to 0x2433) are constants that no sensor has";
  if (!(sensor.corner_c[2] > 0.0 && sensor.corner_c[3] > sensor.corner_c[2]))
    return "its ranges of object temperatures (0x243F) do not ascend";
  if (!has_sensitive_pixels(sensor)) return "pixels without sensitivity (0x2420 to 0x243C, 0x2440 on)";
  return "";
}

Parameters parameters_of(EepromWords words) {
  if (const std::string fault = fault_of(words); !fault.empty())
    throw Error(ExitCode::bad_usage, "this is not an EEPROM of an MLX90640: " + fault, "the camera's EEPROM",
                "read all 832 words from address 0x2400 on, at 400 kHz or slower");
  return read_parameters(Eeprom(words));
}

unsigned subpage_of(HalfFrameWords words) {
  return status_of(words) & 1U;
}

HalfFrameFault fault_of(HalfFrameWords words) {
  if ((status_of(words) & new_data_status) != 0) return HalfFrameFault::torn;
  if ((control_of(words) & chess_control) == 0) return HalfFrameFault::interleaved;
  const unsigned subpage = subpage_of(words);
  for (std::size_t place = 0; place < frame_pixels; ++place)
    if (words[place] == unread_word &&
        thermorig::subpage_of(place / frame_columns, place % frame_columns) == subpage)
      return HalfFrameFault::unread;
  for (const unsigned address : {0x0700U, 0x0708U, 0x070AU, 0x0720U, 0x0728U, 0x072AU})
    if (words[address - 0x0400U] == unread_word) return HalfFrameFault::unread;
  return HalfFrameFault::none;
}

HalfFrameFault calibrate(const Parameters& sensor, HalfFrameWords words, const Surroundings& surroundings,
                         HalfFrame& out) {
  out.subpage = subpage_of(words);
  out.supply_v = supply_of(sensor, words);
  out.sensor_temp_c = sensor_temp_of(sensor, words, out.supply_v);
  if (!is_plausible(out) || ram(words, 0x070A) <= 0.0) return HalfFrameFault::implausible;
  const Conditions now = conditions_of(sensor, words, out, surroundings);
  const bool is_chess = (control_of(words) & chess_control) != 0;
  for (std::size_t place = 0; place < frame_pixels; ++place) {
    const std::size_t row = place / frame_columns, column = place % frame_columns;
    const unsigned half = is_chess ? thermorig::subpage_of(row, column) : static_cast<unsigned>(row % 2);
    out.temp_c[place] = std::numeric_limits<double>::quiet_NaN();
    if (half != out.subpage || is_bad(sensor, place)) continue;
    const double raw = static_cast<std::int16_t>(words[place]);
    out.temp_c[place] = object_temp_of(sensor, now, place, radiation_of(sensor, now, place, raw));
    if (!std::isfinite(out.temp_c[place])) return HalfFrameFault::implausible;
  }
  return HalfFrameFault::none;
}

}  // namespace thermorig::sensors::mlx90640

// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "thermorig/sensors/mlx90640_calibration.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::sensors {

/// Makes images of half-frames. Nothing is guessed: which half is new, the sensor's status word says.
class RawHalves {
 public:
  using Words = std::array<std::uint16_t, mlx90640::half_frame_words>;
  enum class Outcome : std::uint8_t { image, first_half, no_eeprom, refused };

  /// False: these are no constants of a sensor, eeprom_fault() says why, and those before stay.
  bool learn(const std::array<std::uint16_t, mlx90640::eeprom_words>& words) {
    eeprom_fault_ = mlx90640::fault_of(words);
    if (eeprom_fault_.empty()) sensor_ = mlx90640::parameters_of(words);
    return eeprom_fault_.empty();
  }
  bool has_eeprom() const { return sensor_.has_value(); }
  const std::string& eeprom_fault() const { return eeprom_fault_; }

  Outcome push(const Words& words, wire::CameraMessage& message) {
    if (mlx90640::fault_of(words) != mlx90640::HalfFrameFault::none) return Outcome::refused;
    if (!sensor_) return Outcome::no_eeprom;
    if (mlx90640::calibrate(*sensor_, words, {}, half_) != mlx90640::HalfFrameFault::none)
      return Outcome::refused;
    const bool is_repeated = words == last_;
    last_ = words;
    for (std::size_t place = 0; place < frame_pixels; ++place)
      if (subpage_of(place / frame_columns, place % frame_columns) == half_.subpage)
        frame_.temp_c[place] = static_cast<float>(half_.temp_c[place]);
    frame_.sensor_temp_c = static_cast<float>(half_.sensor_temp_c);
    has_half_[half_.subpage] = true;
    if (!has_half_[0] || !has_half_[1]) return Outcome::first_half;
    mend(frame_, sensor_->bad);
    message.frame = frame_;
    constexpr std::uint16_t half_pixels = frame_pixels / 2;
    if (!is_repeated) (half_.subpage == 0 ? message.fresh.even : message.fresh.odd) = half_pixels;
    return Outcome::image;
  }

 private:
  std::optional<mlx90640::Parameters> sensor_;
  std::string eeprom_fault_;  // of the last
  mlx90640::HalfFrame half_;
  ThermalFrame frame_;
  Words last_{};
  std::array<bool, 2> has_half_{};
};

}  // namespace thermorig::sensors

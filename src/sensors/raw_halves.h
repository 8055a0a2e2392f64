// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/sensors/mlx90640_calibration.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::sensors {

/// Makes images of half-frames, and books the bytes that they came in. Nothing is guessed: which half is new,
/// the sensor's status word says.
class RawHalves {
 public:
  using Words = std::array<std::uint16_t, mlx90640::half_frame_words>;
  using Eeprom = std::array<std::uint16_t, mlx90640::eeprom_words>;

  wire::ByteLedger ledger;

  /// The stream was interrupted, and another sensor may come.
  void restart() {
    wire::ByteLedger kept = ledger;
    kept.restart();
    *this = RawHalves();
    ledger = kept;
  }

  /// Of the next `bytes`. What are no constants of a sensor is damage, eeprom_fault() says why, and those
  /// before stay.
  void take_eeprom(const Eeprom& words, std::size_t bytes) {
    eeprom_fault_ = mlx90640::fault_of(words);
    if (!eeprom_fault_.empty()) return ledger.book_damaged(&wire::Counters::bad_value, bytes);
    sensor_ = mlx90640::parameters_of(words);
    ledger.book_reply(bytes);
  }

  /// Of the next `ahead + bytes`, of which those ahead carry nothing.
  void take_half(const Words& words, std::size_t ahead, std::size_t bytes,
                 std::vector<wire::CameraMessage>& out) {
    wire::CameraMessage message;
    const Outcome outcome = push(words, message);
    if (outcome != Outcome::refused) ++half_frames_;
    if (outcome == Outcome::refused || outcome == Outcome::no_eeprom)
      return ledger.book_damaged(&wire::Counters::bad_value, ahead + bytes);
    ledger.book_filler(ahead);
    if (outcome == Outcome::first_half) return ledger.book_reply(bytes);
    ledger.book_data(message, bytes);
    out.push_back(message);
  }

  /// What was heard, whether or not there was an image in it.
  std::uint64_t half_frames() const { return half_frames_; }
  bool has_eeprom() const { return sensor_.has_value(); }
  const std::string& eeprom_fault() const { return eeprom_fault_; }

 private:
  enum class Outcome : std::uint8_t { image, first_half, no_eeprom, refused };

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

  std::uint64_t half_frames_ = 0;
  std::optional<mlx90640::Parameters> sensor_;
  std::string eeprom_fault_;  // of the last
  mlx90640::HalfFrame half_;
  ThermalFrame frame_;
  Words last_{};
  std::array<bool, 2> has_half_{};
};

}  // namespace thermorig::sensors

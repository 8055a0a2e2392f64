// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "thermorig/core/frame.h"

namespace thermorig::simulation {

/// A made-up MLX90640 as its own words: what its EEPROM says, and what its memory holds after it has seen
/// given temperatures. The data sheet's chain (section 11.2) backwards; nothing is shared with what reads it.
class RawMlx90640 {
 public:
  using Eeprom = std::array<std::uint16_t, 832>;     // from 0x2400 on
  using HalfFrame = std::array<std::uint16_t, 834>;  // RAM from 0x0400 on, control, subpage

  struct State {
    double supply_v = 3.3;        // 3.0 to 3.6
    double sensor_temp_c = 35.0;  // -40 to 85
    unsigned resolution = 2;      // of the converter: 16 bits and so many more, 0 to 3
    double emissivity = 0.95;
    double reflected_below_sensor_k = 8.0;
  };

  explicit RawMlx90640(std::uint64_t seed);

  const Eeprom& eeprom() const { return eeprom_; }

  /// Of the chess half 0 or 1; `temp_c` of the other half is not looked at: its words are those of 0 counts.
  /// Words beyond 16 bits stay at the last one.
  HalfFrame half_frame(const std::array<float, frame_pixels>& temp_c, unsigned subpage,
                       const State& state) const;

 private:
  struct Pixel {
    double offset = 0.0, sensitivity = 0.0, kta = 0.0, kv = 0.0;
  };
  void put(unsigned address, unsigned low, unsigned size, int value);
  void make_common();
  void make_pixels(std::uint64_t seed);
  double radiation(double temp_c, double sensitivity, double background) const;

  Eeprom eeprom_{};
  std::array<Pixel, frame_pixels> pixels_{};
};

}  // namespace thermorig::simulation
